//! Charts of outcomes and measures by condition.

use super::{
    Estimate as Found, OutcomeCell, OutcomeShares, OutcomeTable, Quantity, measured,
    published_share,
};
use crate::condition::Condition;
use crate::figure::{
    Estimate, EstimateChart, Look, Medium, Panel, PanelLine, Part, ShareChart, Shares,
};
use crate::labels::Labels;
use crate::stats::summary::quantile;
use crate::studies::findings::Findings;
use crate::studies::{Drawn, End, Outcome};
use crate::table::Value;

/// The factor that limits the time of trials, where there is one.
const DEADLINE: &str = "deadline-s";
const TIME: &str = "time-s";

/// Returns the outcomes in the order in which they are stacked, the best first. Panicked trials are counted nowhere.
fn stack() -> Vec<(Outcome, Look)> {
    let looks = [
        (End::Success, Look::Good),
        (End::TimeUp, Look::Slow),
        (End::Idle, Look::Idle),
        (End::Failure, Look::Bad),
    ];
    let all = Outcome::all();
    let of = |(end, look): (End, Look)| {
        all.iter().filter(move |outcome| outcome.end() == end).map(move |outcome| (*outcome, look))
    };
    looks.into_iter().flat_map(of).collect()
}

/// Returns panels of `cells`, `abreast` rows each, in lines by the first of several factors that have rows.
fn lines<C, R>(
    cells: &[C],
    abreast: usize,
    labels: &Labels,
    rows_of: impl Fn(&C) -> &Condition,
    row: impl Fn(&C) -> R,
) -> Vec<PanelLine<R>> {
    let mut lines: Vec<PanelLine<R>> = Vec::new();
    for group in cells.chunks(abreast.max(1)) {
        let Some(first) = group.first() else { continue };
        let values = rows_of(first);
        let own = usize::from(values.len() > 1);
        let words: Vec<String> = values.iter().map(|(f, v)| labels.in_words(f, v)).collect();
        let line = words[..own].join(", ");
        let limit = values.iter().skip(own).find(|(factor, _)| factor == DEADLINE);
        let panel = Panel {
            name: words[own..].join(", "),
            rows: group.iter().map(&row).collect(),
            mark: limit.and_then(|(_, value)| value.parse().ok()),
        };
        match lines.last_mut() {
            Some(last) if last.name == line => last.panels.push(panel),
            _ => lines.push(PanelLine { name: line, panels: vec![panel] }),
        }
    }
    lines
}

impl OutcomeTable {
    /// Draws the figure of estimates, where trials have any.
    pub(in crate::studies) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        medium: Medium,
    ) -> Option<Drawn> {
        let chart = findings.outcome_figure(title, self);
        if chart.is_empty() {
            return None;
        }
        let (kind, caption) = match (chart.boxes.is_empty(), self.over.is_none()) {
            (true, true) => (
                "Bar chart",
                "Bars are ours; hollow diamonds under them the paper's. Lines are 95 % intervals.",
            ),
            (false, true) => (
                "Dot chart",
                "Dots are our means with 95 % intervals, boxes the middle half of our trials, n their number; hollow \
                 diamonds under them are the paper's means.",
            ),
            (true, false) => (
                "Bar chart",
                "Bars are ours, all trials together; narrow boxes span 5 to 95 % of what each value of a factor has by itself, \
                 ticks are its median. Hollow diamonds under them are the paper's with 95 % intervals.",
            ),
            (false, false) => (
                "Dot chart",
                "Dots are our means, all trials together; narrow boxes span 5 to 95 % of what each value of a factor has by \
                 itself, ticks are its median, n is the number of trials. Hollow diamonds under them are the paper's means.",
            ),
        };
        let (svg, data) = (chart.to_svg_on(medium), chart.data());
        Some(Drawn::new((kind, title), svg, chart.in_words(), caption, data))
    }
}

impl OutcomeShares {
    /// Draws the figure of shares, where trials have ended.
    pub(in crate::studies) fn draw(
        &self,
        title: &str,
        findings: &Findings<'_>,
        medium: Medium,
    ) -> Option<Drawn> {
        let chart = findings.shares_figure(title, self);
        let caption = "How trials ended, in percent of all of a condition: thick bars are ours, thin ones under them the \
                       paper's.";
        (!chart.is_empty()).then(|| {
            let (svg, data) = (chart.to_svg_on(medium), chart.data());
            Drawn::new(("Stacked bars", title), svg, chart.in_words(), caption, data)
        })
    }
}

impl Findings<'_> {
    /// Makes a requested figure: estimates with intervals, the paper's numbers under ours.
    fn outcome_figure(&self, title: &str, request: &OutcomeTable) -> EstimateChart {
        let names = self.shown_columns(request);
        let cells = self.outcome_cells(request);
        let is_mean = matches!(request.show, Quantity::Mean(_));
        let by_deadline = matches!(&request.show, Quantity::Mean(measure) if measure == TIME)
            && request.rows.iter().any(|factor| factor == DEADLINE);
        let row = |cell: &OutcomeCell| self.estimate(request, cell);
        let mut lines = lines(&cells, names.len(), self.labels, |cell| &cell.rows, row);
        if !by_deadline {
            lines.iter_mut().flat_map(|l| &mut l.panels).for_each(|panel| panel.mark = None);
        }
        EstimateChart {
            title: title.to_owned(),
            quantity: request.show.axis_title(),
            interval: "95 % interval".to_owned(),
            boxes: if is_mean { "middle half of trials".to_owned() } else { String::new() },
            band: request.over.as_ref().map_or_else(String::new, |over| {
                format!("5 to 95 % over {}, median", self.labels.factor(over))
            }),
            mark: if by_deadline { "deadline".to_owned() } else { String::new() },
            names,
            lines,
            end: matches!(request.show, Quantity::Share(_)).then_some(100.0),
        }
    }

    fn estimate(&self, request: &OutcomeTable, cell: &OutcomeCell) -> Estimate {
        let middle_half = match &request.show {
            Quantity::Mean(measure) if request.over.is_none() => {
                let only: Condition = request.only.iter().map(|(f, v)| (f, &v.0)).collect();
                let fixed = only.and(&cell.rows).with(&request.by, &cell.by);
                let mut trials = self.matching(&fixed);
                trials.retain(|trial| trial.outcome() != Outcome::PANICKED);
                let values = measured(&trials, measure);
                (values.len() > 3).then(|| (quantile(&values, 0.25), quantile(&values, 0.75)))
            }
            Quantity::Mean(_) | Quantity::Share(_) | Quantity::Percent(_) => None,
        };
        let is_share = matches!(request.show, Quantity::Share(_));
        let published_interval =
            cell.published.filter(|_| is_share).and_then(|(value, n)| published_share(value, n?));
        Estimate {
            value: cell.ours.map(|e: Found| e.value),
            interval: cell.ours.and_then(|e| e.interval).filter(|_| request.over.is_none()),
            band: cell.band.map(|band| [band.low, band.median, band.high]),
            middle_half,
            n: Some(cell.ours.map_or(0, |e| e.n)),
            published: cell.published.map(|p| p.0),
            published_interval,
        }
    }

    /// Makes a requested figure: the shares of trials by how they ended, stacked; the paper's shares in thin bars under
    /// ours.
    fn shares_figure(&self, title: &str, request: &OutcomeShares) -> ShareChart {
        let table = OutcomeTable {
            show: Quantity::Share(Vec::new()),
            by: request.by.clone(),
            rows: request.rows.clone(),
            only: request.only.clone(),
            published: None,
            over: None,
        };
        let names = self.shown_columns(&table);
        let cells = self.outcome_cells(&table);
        let ended = |outcome: Outcome| self.ledger.count(outcome) > 0;
        let printed =
            |outcome| request.published.iter().any(|share| share.of.first() == Some(&outcome));
        let parts: Vec<(Outcome, Look)> = stack()
            .into_iter()
            .filter(|(outcome, _)| ended(*outcome) || printed(*outcome))
            .collect();
        let row = |cell: &OutcomeCell| {
            let only: Condition = request.only.iter().map(|(f, v)| (f, &v.0)).collect();
            let fixed = only.and(&cell.rows).with(&request.by, &cell.by);
            self.shares(request, &parts, &fixed)
        };
        let named_part = |(outcome, look): &(Outcome, Look)| {
            let with = request.published.iter().find(|share| share.of.first() == Some(outcome));
            let all = with.map_or(&[][..], |share| share.of.as_slice());
            let names: Vec<&str> = all.iter().map(|other| other.name()).collect();
            let name = if names.len() < 2 {
                outcome.name().to_owned()
            } else {
                format!("{} (paper: {})", outcome.name(), names.join(" or "))
            };
            Part { name, look: *look }
        };
        ShareChart {
            title: title.to_owned(),
            quantity: "share of trials (%)".to_owned(),
            parts: parts.iter().map(named_part).collect(),
            lines: lines(&cells, names.len(), self.labels, |cell| &cell.rows, row),
            names,
        }
    }

    fn shares(
        &self,
        request: &OutcomeShares,
        parts: &[(Outcome, Look)],
        fixed: &Condition,
    ) -> Shares {
        let mut trials = self.matching(fixed);
        trials.retain(|trial| trial.outcome() != Outcome::PANICKED);
        let all = crate::stats::length(&trials);
        let share = |(outcome, _): &(Outcome, Look)| {
            let of: Vec<_> = trials.iter().filter(|r| r.outcome() == *outcome).collect();
            100.0 * crate::stats::length(&of) / all
        };
        // What the paper counts together stands at the first of its outcomes.
        let printed = |(outcome, _): &(Outcome, Look)| {
            let of = request.published.iter().find(|share| share.of.first() == Some(outcome))?;
            let (table, row) = self.published_row(&of.table, fixed)?;
            Some(Value::as_f64(table.value(row, "value")).unwrap_or(0.0))
        };
        let published: Vec<Option<f64>> = parts.iter().map(printed).collect();
        let known = published.iter().any(Option::is_some);
        Shares {
            ours: if trials.is_empty() { Vec::new() } else { parts.iter().map(share).collect() },
            published: published.into_iter().filter(|_| known).map(|p| p.unwrap_or(0.0)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::PublishedShare;
    use super::*;
    use crate::factor::Factor;
    use crate::studies::{Ledger, PublishedScatter, Scale, TableLayout, TableRequest, TrialRecord};
    use crate::table::Table;
    use std::collections::BTreeMap;

    /// Returns ten trials each of two strategies within two deadlines; `slow` is late in the last three, without a
    /// time.
    fn records() -> Vec<TrialRecord> {
        let line = format!(
            "{{\"key\":\"{}\",\"condition\":[],\"trial\":0,\"outcome\":\"reached\",\"measures\":{{}},\"series\":[],\
             \"sim-seconds\":1,\"chain\":[]}}",
            "0".repeat(64)
        );
        let blank = TrialRecord::from_line(&line).unwrap();
        let mut records = Vec::new();
        for (deadline, strategy) in
            [("90", "quick"), ("90", "slow"), ("30", "quick"), ("30", "slow")]
        {
            for trial in 0..10_u32 {
                let late = strategy == "slow" && trial > 6;
                let mut record = blank.clone();
                record.condition = Condition::from([
                    ("start", "A"),
                    ("deadline-s", deadline),
                    ("strategy", strategy),
                ]);
                record.trial = trial;
                record.outcome = if late { Outcome::LATE } else { Outcome::REACHED };
                let time = (!late).then_some(20.0 + f64::from(trial));
                record.measures.insert("time-s".to_owned(), time);
                records.push(record);
            }
        }
        records
    }

    fn with_findings<T>(ask: impl FnOnce(&Findings<'_>) -> T) -> T {
        let factors = [
            ("start", &["A"][..]),
            ("deadline-s", &["90", "30"]),
            ("strategy", &["quick", "slow"]),
        ]
        .map(|(name, values)| Factor::new(name, values.iter().copied()));
        let csv = |text: &str| Table::from_csv(text).unwrap();
        let published = BTreeMap::from([
            (
                "reached".to_owned(),
                csv(
                    "deadline-s,strategy,value,n\n90,quick,80,50\n90,slow,30,50\n30,quick,100,50\n",
                ),
            ),
            ("late".to_owned(), csv("deadline-s,strategy,value\n90,quick,20\n90,slow,70\n")),
        ]);
        let records = records();
        ask(&Findings::new(&factors, &Ledger::of(&records), &published))
    }

    fn table(show: Quantity, published: Option<&str>) -> OutcomeTable {
        OutcomeTable {
            show,
            by: "strategy".to_owned(),
            rows: vec!["start".to_owned(), "deadline-s".to_owned()],
            only: BTreeMap::new(),
            over: None,
            published: published.map(str::to_owned),
        }
    }

    #[test]
    fn panels_are_deadlines_in_a_line_for_each_start_with_the_papers_interval() {
        let chart = with_findings(|f| {
            f.outcome_figure(
                "Success",
                &table(Quantity::Share(vec![Outcome::REACHED]), Some("reached")),
            )
        });
        let line = &chart.lines[0];
        assert_eq!((chart.lines.len(), line.name.as_str()), (1, "start A"));
        let names: Vec<&str> = line.panels.iter().map(|panel| panel.name.as_str()).collect();
        assert_eq!(names, ["deadline 90 s", "deadline 30 s"]);
        let slow = line.panels[0].rows[1];
        assert_eq!((slow.value, slow.published, chart.end), (Some(70.0), Some(30.0), Some(100.0)));
        let (low, high) = slow.published_interval.unwrap();
        assert!(
            (low - 19.1).abs() < 0.1 && (high - 43.75).abs() < 0.1,
            "Wilson's of 15 of 50: {low} {high}"
        );
        assert_eq!(line.panels[1].rows[1].published, None, "not printed");
    }

    #[test]
    fn times_stand_against_their_deadline_with_the_trials_behind_them() {
        let chart = with_findings(|f| {
            f.outcome_figure("Time", &table(Quantity::Mean("time-s".to_owned()), None))
        });
        let panel = &chart.lines[0].panels[1];
        assert_eq!((panel.mark, chart.mark.as_str()), (Some(30.0), "deadline"));
        let slow = panel.rows[1];
        assert_eq!(
            (slow.value, slow.n, slow.middle_half),
            (Some(23.0), Some(7), Some((21.5, 24.5)))
        );
    }

    #[test]
    fn shares_add_up_and_what_the_paper_counts_together_is_one_part() {
        let chart = with_findings(|f| {
            let share = |of: &[Outcome], table: &str| PublishedShare {
                of: of.to_vec(),
                table: table.to_owned(),
            };
            f.shares_figure(
                "Ends",
                &OutcomeShares {
                    by: "strategy".to_owned(),
                    rows: vec!["deadline-s".to_owned()],
                    only: BTreeMap::new(),
                    published: vec![
                        share(&[Outcome::REACHED], "reached"),
                        share(&[Outcome::LATE, Outcome::STALLED], "late"),
                    ],
                },
            )
        });
        let parts: Vec<&str> = chart.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(parts, ["reached", "late (paper: late or stalled)"]);
        let row = &chart.lines[0].panels[0].rows[1];
        assert_eq!(
            (row.ours.as_slice(), row.published.as_slice()),
            (&[70.0, 30.0][..], &[30.0, 70.0][..])
        );
        assert!(chart.lines[0].panels[1].rows[1].published.is_empty(), "not printed");
    }

    #[test]
    fn a_scatter_has_a_point_for_each_printed_number_and_tells_how_near_it_is() {
        let show = Quantity::Share(vec![Outcome::REACHED]);
        let tables = [TableRequest {
            id: "success".to_owned(),
            title: String::new(),
            layout: TableLayout::OutcomeTable(table(show, Some("reached"))),
        }];
        let wanted = |table: &str| PublishedScatter {
            table: table.to_owned(),
            by: Some("deadline-s".to_owned()),
            scale: Scale::Linear,
            ratios: false,
        };
        let chart = with_findings(|f| f.scatter_figure("Both", &wanted("success"), &tables));
        let points: Vec<_> = chart.points.iter().map(|p| (p.group, p.published, p.ours)).collect();
        assert_eq!(points, [(0, 80.0, 100.0), (0, 30.0, 70.0), (1, 100.0, 100.0)]);
        assert_eq!(chart.groups, ["deadline 90 s", "deadline 30 s"]);
        // Differences of 20, 40 and 0.
        assert_eq!(
            chart.notes,
            ["3 cells, r = 0.96", "RMSE 26 points", "mean +20 points to paper"]
        );
        assert!(
            with_findings(|f| f.scatter_figure("Both", &wanted("none"), &tables)).points.is_empty()
        );
    }
}

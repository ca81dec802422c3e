//! Charts of outcomes and measures by condition.

use super::{
    Estimate as Found, OutcomeCell, OutcomeShares, OutcomeTable, Quantity, measured,
    published_share,
};
use crate::figure::{Estimate, EstimateChart, Look, Panel, PanelLine, Part, ShareChart, Shares};
use crate::stats::summary::quantile;
use crate::studies::Outcome;
use crate::studies::findings::Findings;
use crate::table::Value;

/// The factor that limits the time of trials, where there is one.
const DEADLINE: &str = "deadline-s";
const TIME: &str = "time-s";

/// Outcomes in the order in which they are stacked. Panicked trials are counted nowhere.
const STACK: [(Outcome, Look); 7] = [
    (Outcome::Reached, Look::Good),
    (Outcome::Explored, Look::Good),
    (Outcome::Late, Look::Slow),
    (Outcome::TimeLimit, Look::Slow),
    (Outcome::Stalled, Look::Idle),
    (Outcome::Collided, Look::Bad),
    (Outcome::Stuck, Look::Bad),
];

/// A factor's value in words: `deadline 680 s`, `furnished true`.
pub(in crate::studies) fn named(factor: &str, value: &str) -> String {
    let units = [("-m-s", "m/s"), ("-s", "s"), ("-m", "m"), ("-deg", "°"), ("-percent", "%")];
    for (suffix, unit) in units {
        if let Some(name) = factor.strip_suffix(suffix)
            && value.parse::<f64>().is_ok()
        {
            return format!("{} {value} {unit}", name.replace('-', " "));
        }
    }
    format!("{} {value}", factor.replace('-', " "))
}

/// Values in words, separated by commas.
fn all_named(values: &[(String, String)]) -> String {
    values.iter().map(|(f, v)| named(f, v)).collect::<Vec<_>>().join(", ")
}

/// Panels of `cells`, `abreast` rows each, in lines by the first of several factors that have rows.
fn lines<C, R>(
    cells: &[C],
    abreast: usize,
    rows_of: impl Fn(&C) -> &[(String, String)],
    row: impl Fn(&C) -> R,
) -> Vec<PanelLine<R>> {
    let mut lines: Vec<PanelLine<R>> = Vec::new();
    for group in cells.chunks(abreast.max(1)) {
        let Some(first) = group.first() else { continue };
        let values = rows_of(first);
        let (line, panel) = values.split_at(usize::from(values.len() > 1));
        let line = all_named(line);
        let limit = panel.iter().find(|(factor, _)| factor == DEADLINE);
        let panel = Panel {
            name: all_named(panel),
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

impl Findings<'_> {
    /// A requested figure: estimates with intervals, the paper's numbers under ours.
    pub fn outcome_figure(&self, title: &str, request: &OutcomeTable) -> EstimateChart {
        let names = self.columns_of(request);
        let cells = self.outcome_cells(request);
        let is_mean = matches!(request.show, Quantity::Mean(_));
        let by_deadline = matches!(&request.show, Quantity::Mean(measure) if measure == TIME)
            && request.rows.iter().any(|factor| factor == DEADLINE);
        let row = |cell: &OutcomeCell| self.estimate(request, cell);
        let mut lines = lines(&cells, names.len(), |cell| &cell.rows, row);
        if !by_deadline {
            lines.iter_mut().flat_map(|l| &mut l.panels).for_each(|panel| panel.mark = None);
        }
        EstimateChart {
            title: title.to_owned(),
            quantity: request.show.axis_title(),
            interval: "95 % interval".to_owned(),
            boxes: if is_mean { "middle half of trials".to_owned() } else { String::new() },
            mark: if by_deadline { "deadline".to_owned() } else { String::new() },
            names,
            lines,
            end: matches!(request.show, Quantity::Share(_)).then_some(100.0),
        }
    }

    fn estimate(&self, request: &OutcomeTable, cell: &OutcomeCell) -> Estimate {
        let middle_half = match &request.show {
            Quantity::Mean(measure) => {
                let mut fixed: Vec<(String, String)> =
                    request.only.iter().map(|(f, v)| (f.clone(), v.0.clone())).collect();
                fixed.extend(cell.rows.iter().cloned());
                fixed.push((request.by.clone(), cell.by.clone()));
                let mut trials = self.matching(&fixed);
                trials.retain(|record| record.outcome != Outcome::Panicked);
                let values = measured(&trials, measure);
                (values.len() > 3).then(|| (quantile(&values, 0.25), quantile(&values, 0.75)))
            }
            Quantity::Share(_) | Quantity::Percent(_) => None,
        };
        let is_share = matches!(request.show, Quantity::Share(_));
        let published_interval =
            cell.published.filter(|_| is_share).and_then(|(value, n)| published_share(value, n?));
        Estimate {
            value: cell.ours.map(|e: Found| e.value),
            interval: cell.ours.and_then(|e| e.interval),
            middle_half,
            n: Some(cell.ours.map_or(0, |e| e.n)),
            published: cell.published.map(|p| p.0),
            published_interval,
        }
    }

    /// A requested figure: how the ways in which trials ended add up, the paper's shares in thin bars under ours.
    pub fn shares_figure(&self, title: &str, request: &OutcomeShares) -> ShareChart {
        let table = OutcomeTable {
            show: Quantity::Share(Vec::new()),
            by: request.by.clone(),
            rows: request.rows.clone(),
            only: request.only.clone(),
            published: None,
        };
        let names = self.columns_of(&table);
        let cells = self.outcome_cells(&table);
        let ended = |outcome: Outcome| self.records.iter().any(|r| r.outcome == outcome);
        let printed =
            |outcome| request.published.iter().any(|share| share.of.first() == Some(&outcome));
        let parts: Vec<(Outcome, Look)> =
            STACK.into_iter().filter(|(outcome, _)| ended(*outcome) || printed(*outcome)).collect();
        let row = |cell: &OutcomeCell| {
            let mut fixed: Vec<(String, String)> =
                request.only.iter().map(|(f, v)| (f.clone(), v.0.clone())).collect();
            fixed.extend(cell.rows.iter().cloned());
            fixed.push((request.by.clone(), cell.by.clone()));
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
            names,
            lines: lines(&cells, self.columns_of(&table).len(), |cell| &cell.rows, row),
        }
    }

    fn shares(
        &self,
        request: &OutcomeShares,
        parts: &[(Outcome, Look)],
        fixed: &[(String, String)],
    ) -> Shares {
        let mut trials = self.matching(fixed);
        trials.retain(|record| record.outcome != Outcome::Panicked);
        let all = crate::stats::length(&trials);
        let share = |(outcome, _): &(Outcome, Look)| {
            let of: Vec<_> = trials.iter().filter(|r| r.outcome == *outcome).collect();
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

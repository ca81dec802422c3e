//! What is shown of effects.

use super::Effect;
use crate::labels::Labels;
use crate::studies::columns::Columns;
use crate::studies::exhibit::{Abreast, Grid, GridCell, Layout, Lines, Measured, Set, Source};
use crate::studies::prior_map::{EffectsTable, Metric};
use crate::studies::{Findings, TableRequest};
use crate::table::{Column, Table, Value};

/// Lines of the printed table; the tidy one has all.
const PRINTED: usize = 25;

impl Layout for EffectsTable {
    type Cell = Effect;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<Effect> {
        findings.effects(self)
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, Effect> {
        let (unit, metric) = match self.metric {
            Metric::DistanceM => ("m", "way travelled"),
            Metric::TimeS => ("s", "simulated time"),
        };
        let never = "no condition has runs of both levels that got there";
        let few = "no condition has two runs of both levels that got there";
        let no_gap = "the paper prints none, or no run got there";
        let percent =
            |name: &str, meaning: &str| Column::number(name, "%", meaning).empty_where(never);
        Columns::<Effect>::none()
            .with(
                Column::of_values(
                    "factor",
                    "",
                    "The factor whose levels are compared",
                    &self.factors,
                ),
                |effect| effect.factor.clone(),
            )
            .with(Column::text("level", "The level"), |effect| effect.level.clone())
            .with(
                Column::text("against", "The level it is compared with: the factor's first"),
                |effect| effect.against.clone(),
            )
            .factors(&self.within, findings, |effect| &effect.within)
            .with(Column::percent("coverage-percent", "Level of coverage"), |effect| {
                i64::from(effect.percent)
            })
            .number(
                percent(
                    "effect-percent",
                    &format!(
                        "By how much the level moves the {metric} at that coverage: ratio of geometric means over matched \
                         conditions, less one"
                    ),
                ),
                Effect::percent_moved,
            )
            .number(
                percent("effect-low", "Lower end of its 95 % interval").empty_where(few),
                |effect| effect.interval_percent().map(|(low, _)| low),
            )
            .number(
                percent("effect-high", "Upper end of its 95 % interval").empty_where(few),
                |effect| effect.interval_percent().map(|(_, high)| high),
            )
            .number(
                Column::probability("p", "Two-sided p of no effect (Welch, matched conditions)")
                    .empty_where(few),
                |effect| effect.test.map(|test| test.tails.two_sided),
            )
            .count(
                "matched-conditions",
                "Combinations of all other factors that were run at both levels",
                |effect| effect.matched,
            )
            .count(
                "compared-conditions",
                "Those of them with runs of both levels that got there",
                |effect| effect.compared,
            )
            .count("n", "Runs at the level that reached the coverage", |effect| effect.runs.reached)
            .count("trials", "Runs at the level", |effect| effect.runs.trials)
            .count("against-n", "Runs at the first level that reached the coverage", |effect| {
                effect.runs_against.reached
            })
            .count("against-trials", "Runs at the first level", |effect| effect.runs_against.trials)
            .number(
                Column::number(
                    "against-geometric-mean",
                    unit,
                    &format!("Geometric mean of the {metric} at the first level"),
                )
                .at_least(0.0)
                .empty_where(never),
                |effect| effect.mean_against,
            )
            .with(
                Column::number("published", unit, "The mean that the paper prints")
                    .at_least(0.0)
                    .empty_where("the paper prints none"),
                |effect| effect.published,
            )
            .number(
                percent(
                    "gap-percent",
                    "By how much the paper's mean is above that of the first level",
                )
                .empty_where(no_gap),
                Effect::gap_percent,
            )
            .number(
                Column::number(
                    "share-of-gap",
                    "",
                    "The effect as a share of that gap, of logarithms: 1 closes it, below 0 widens it",
                )
                .empty_where(no_gap),
                Effect::share_of_gap,
            )
    }

    /// Sets the largest effects as lines. On the page one line a level of a factor in a cell of the design: the coverages stand
    /// side by side, and beside each effect what lies between the first level and the paper.
    fn set(&self, cells: &[Effect], findings: &Findings<'_>) -> Set {
        let labels = findings.labels;
        let (table, more) = in_print(cells, labels);
        let abreast = Abreast {
            cells,
            of: self.at.len(),
            label: |effect: &Effect| {
                [vec![choice(effect, labels)], labels.values(&effect.within)].concat()
            },
        };
        let measured = |mean: f64, n: Option<u64>| Measured { mean, sd: None, n };
        Set {
            grid: Grid {
                quantity: format!(
                    "effect on {} (%); gap: what lies between the first level and the paper (%)",
                    self.metric.name()
                ),
                beside: "gap",
                source: Source::of(self.published.as_ref()),
                decimals: 0,
                of_trials: false,
                row_header: "level, in".to_owned(),
                columns: self.at.iter().map(|percent| format!("{percent} %")).collect(),
                rows: abreast.rows(|effect| GridCell {
                    ours: effect.percent_moved().map(|x| measured(x, Some(effect.runs.reached))),
                    published: effect.gap_percent().map(|x| measured(x, None)),
                    ..GridCell::default()
                }),
            },
            print: Some(table.clone()),
            lines: Lines::all(table, 1, [0, 1]),
            legend: vec![
                "largest first; means of ln over matched conditions; runs that got there of all, of either level; paper: \
                 from our mean at the first level to the paper's"
                    .to_owned(),
            ],
            more,
        }
    }
}

/// Returns what is chosen instead of what, by labels where there are any.
fn choice(effect: &Effect, labels: &Labels) -> String {
    let Effect { factor, level, against, .. } = effect;
    let [level, against] = [level, against].map(|value| labels.value(factor, value));
    format!("{} {level} for {against}", labels.factor(factor))
}

/// Returns the largest effects, up or down, and how many more there are.
fn in_print(effects: &[Effect], labels: &Labels) -> (Table, usize) {
    let mut effects: Vec<&Effect> = effects.iter().collect();
    let size = |effect: &Effect| effect.log_ratio.map_or(-1.0, f64::abs);
    // Stable: equal effects stay in the order of the request.
    effects.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let more = effects.len().saturating_sub(PRINTED);
    let mut table = Table::new(["level", "in", "at", "effect", "95 %", "runs", "paper"]);
    for effect in effects.into_iter().take(PRINTED) {
        let points = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:+.0} %"));
        let interval = effect
            .interval_percent()
            .map_or("-".to_owned(), |(low, high)| format!("{low:+.0} to {high:+.0}"));
        let (here, there) = (effect.runs, effect.runs_against);
        let texts = [
            choice(effect, labels),
            labels.values(&effect.within).join(", "),
            format!("{} %", effect.percent),
            points(effect.percent_moved()),
            interval,
            format!("{}/{}, {}/{}", here.reached, here.trials, there.reached, there.trials),
            points(effect.gap_percent()),
        ];
        table.push(texts.map(Value::from).to_vec());
    }
    (table, more)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{request, with_findings};
    use super::*;

    #[test]
    fn the_print_ranks_by_size_and_says_how_many_it_leaves_out() {
        with_findings(|findings| {
            let wanted = request(&["noise", "gain", "ray-stop"], &["environment"], &[70, 80]);
            let effects = findings.effects(&wanted);
            let (print, more) = in_print(&effects, findings.labels);
            assert_eq!((effects.len(), print.rows.len(), more), (6, 6, 0));
            let first: Vec<&str> = effects.iter().map(|effect| effect.factor.as_str()).collect();
            assert_eq!(first, ["noise", "noise", "gain", "gain", "ray-stop", "ray-stop"]);
            let levels: Vec<String> =
                print.rows.iter().map(|row| format!("{} at {}", row[0], row[2])).collect();
            assert_eq!(
                levels,
                [
                    "ray-stop even for uneven at 80 %",
                    "noise 0.01 for 0.1 at 80 %",
                    "gain released for paper at 80 %",
                    "noise 0.01 for 0.1 at 70 %",
                    "gain released for paper at 70 %",
                    "ray-stop even for uneven at 70 %",
                ]
            );
            assert_eq!(print.value(&print.rows[2], "runs").to_string(), "4/5, 4/4");
            assert_eq!(print.value(&print.rows[2], "paper").to_string(), "-45 %");
            let many: Vec<u32> = (0..30).map(|_| 80).collect();
            let (print, more) =
                in_print(&findings.effects(&request(&["gain"], &[], &many)), findings.labels);
            assert_eq!((print.rows.len(), more), (PRINTED, 5));
        });
    }
}

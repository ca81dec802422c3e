//! A proposal as the measures of a trial, and back.

use super::{Below, Drawn, Inference, Proposal};
use crate::studies::findings::rounded;
use crate::studies::{Entry, Measures};
use crate::table::Column;

/// What the beginnings of the names of measures mean.
const MEANINGS: [(&str, &str); 11] = [
    (
        "evidence-",
        "Logarithm of the likelihood of what is learned from, averaged over the prior in this building: by hold-out",
    ),
    ("value-", "The same for one value of a prior: number of the prior, number of the value"),
    (
        "draw-cell-",
        "Probability of an outcome by a posterior draw: number of the draw, of the cell, of the outcome",
    ),
    (
        "draw-time-",
        "Mean time (s) of the first outcome by a posterior draw: number of the draw, of the cell",
    ),
    ("draw-", "A posterior draw: its number, and the number of what is supposed"),
    (
        "prior-cell-",
        "Probability of an outcome by a prior draw: number of the draw, of the cell, of the outcome",
    ),
    (
        "prior-time-",
        "Mean time (s) of the first outcome by a prior draw: number of the draw, of the cell",
    ),
    ("prior-", "A prior draw: its number, and the number of what is supposed"),
    (
        "held-",
        "Expected share of the first outcome in a cell that is held out: number of the hold-out, of the cell",
    ),
    (
        "simulated-below-",
        "Logarithm of a simulated table's likelihood by draws below its truth: number of the table, of the prior",
    ),
    (
        "simulated-",
        "Logarithm of a simulated table's likelihood, averaged over the prior in this building",
    ),
];

/// Describes the measure `name` of an inference's trials; `None` where they have none of that name.
pub fn measure(name: &str) -> Option<Column> {
    let numbers = |rest: &str| rest.bytes().all(|b| b.is_ascii_digit() || b == b'-');
    let fits = |(beginning, _): &&(&str, &str)| {
        name.strip_prefix(beginning).is_some_and(|rest| !rest.is_empty() && numbers(rest))
    };
    let (_, meaning) = MEANINGS.iter().find(fits)?;
    Some(
        Column::number(name, "", meaning).empty_where("it is impossible, or there is no such draw"),
    )
}

/// Returns whether the measure `name` of a proposal is one of the many of its draws and tables.
pub fn of_draws(name: &str) -> bool {
    ["draw-", "prior-", "held-", "simulated-"].iter().any(|beginning| name.starts_with(beginning))
}

impl Proposal {
    /// Returns it as measures.
    pub(super) fn measures(&self) -> Measures {
        let mut measures = Measures::new();
        let mut put = |name: String, value: f64| {
            measures.insert(name, value.is_finite().then(|| rounded(value)));
        };
        for (h, ln) in self.ln_evidence.iter().enumerate() {
            put(format!("evidence-{h:02}"), *ln);
        }
        for (p, values) in self.by_value.iter().enumerate() {
            for (v, ln) in values.iter().enumerate() {
                put(format!("value-{p:02}-{v:02}"), *ln);
            }
        }
        for (beginning, draws) in [("draw", &self.draws), ("prior", &self.prior)] {
            for (d, drawn) in draws.iter().enumerate() {
                for (q, value) in drawn.values.iter().enumerate() {
                    put(format!("{beginning}-{d:02}-{q:02}"), *value);
                }
                for (c, outcomes) in drawn.cells.iter().enumerate() {
                    for (o, share) in outcomes.iter().enumerate() {
                        put(format!("{beginning}-cell-{d:02}-{c:03}-{o}"), thousandths(*share));
                    }
                }
                for (c, time_s) in drawn.times.iter().enumerate() {
                    let tenths = time_s.map_or(f64::NAN, |time_s| (10.0 * time_s).round() / 10.0);
                    put(format!("{beginning}-time-{d:02}-{c:03}"), tenths);
                }
            }
        }
        for (h, cells) in self.held.iter().enumerate() {
            for (c, share) in cells {
                put(format!("held-{:02}-{c:03}", h + 1), thousandths(*share));
            }
        }
        for (t, simulated) in self.simulated.iter().enumerate() {
            put(format!("simulated-{t:02}"), simulated.ln_evidence);
            for (p, ln) in simulated.below.iter().enumerate() {
                put(format!("simulated-below-{t:02}-{p:02}"), *ln);
            }
        }
        measures
    }

    /// Reads it back from a trial of `inference`, which supposes `quantities`; `None` where the trial failed.
    pub(super) fn of(trial: Entry<'_>, inference: &Inference, quantities: usize) -> Option<Self> {
        let ln = |name: String| trial.number(&name).unwrap_or(f64::NEG_INFINITY);
        trial.says("evidence-00").then_some(())?;
        let cells = inference.observed.cells.len();
        let drawn = |beginning: &str, d: usize| {
            let value = |name: String| trial.number(&name);
            let values = (0..quantities).map(|q| value(format!("{beginning}-{d:02}-{q:02}")));
            let outcome = |c: usize, o: usize| value(format!("{beginning}-cell-{d:02}-{c:03}-{o}"));
            Some(Drawn {
                values: values.collect::<Option<_>>()?,
                cells: (0..cells)
                    .map(|c| Some([outcome(c, 0)?, outcome(c, 1)?]))
                    .collect::<Option<_>>()?,
                times: (0..if inference.times.is_some() { cells } else { 0 })
                    .map(|c| value(format!("{beginning}-time-{d:02}-{c:03}")))
                    .collect(),
            })
        };
        let held = |h: usize| {
            let share = |c: usize| Some((c, trial.number(&format!("held-{h:02}-{c:03}"))?));
            (0..cells).filter_map(share).collect()
        };
        let continuous = inference.priors.iter().filter(|prior| prior.is_continuous()).count();
        Some(Self {
            ln_evidence: (0..inference.hold_outs.len())
                .map(|h| ln(format!("evidence-{h:02}")))
                .collect(),
            by_value: inference
                .priors
                .iter()
                .enumerate()
                .map(|(p, prior)| {
                    (0..prior.values().len()).map(|v| ln(format!("value-{p:02}-{v:02}"))).collect()
                })
                .collect(),
            draws: (0..100).map_while(|d| drawn("draw", d)).collect(),
            prior: (0..100).map_while(|d| drawn("prior", d)).collect(),
            held: (1..inference.hold_outs.len()).map(held).collect(),
            simulated: (0..inference.simulated_tables as usize)
                .map(|t| Below {
                    ln_evidence: ln(format!("simulated-{t:02}")),
                    below: (0..continuous)
                        .map(|p| ln(format!("simulated-below-{t:02}-{p:02}")))
                        .collect(),
                })
                .collect(),
        })
    }
}

fn thousandths(share: f64) -> f64 {
    (1000.0 * share).round() / 1000.0
}

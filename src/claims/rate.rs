//! `rate`: two quantities of the same trials.

use super::cells::Where;
use super::comparison::directed;
use super::gather::{Bench, Draft, Evidence};
use super::measuring::{Quantity, Rate};
use super::metric::Metric;
use super::terms::{Side, Sides};
use super::verdict::{CellNumbers, Effect};
use crate::stats::bootstrap::bootstrap;
use crate::stats::{Tails, real};

/// What one trial adds to a quantity and to what it is counted per.
type Part = (f64, f64);

/// By resampling trials within conditions, so that what happened in one trial stays together: its maneuvers, or
/// that a trial which ended one way did not end the other.
pub(super) fn rate(bench: &Bench<'_>, form: &Rate) -> Vec<Draft> {
    let sign = if form.direction == Side::Less { "<" } else { ">" };
    let mut drafts = Vec::new();
    for pins in form.for_each.combinations() {
        let cell = form.r#where.pinned(&pins);
        let about = format!("{} {sign} {} in ({cell})", form.of, form.than);
        let (first, second) =
            (gathered(bench, &cell, &form.of), gathered(bench, &cell, &form.than));
        let (cells, conditions) = ([first.cells, second.cells].concat(), first.conditions);
        let evidence = first.parts.and_then(|first| {
            let second = second.parts?;
            compared(bench, &about, form, &first, &second)
        });
        let notes = Vec::new();
        drafts.push(Draft { about, test: "bootstrap", cells, conditions, evidence, notes });
    }
    drafts
}

struct Gathered {
    cells: Vec<CellNumbers>,
    conditions: Vec<usize>,
    /// By condition and trial.
    parts: Result<Vec<Vec<Part>>, String>,
}

fn gathered(bench: &Bench<'_>, cell: &Where, quantity: &Quantity) -> Gathered {
    let metrics: Vec<Metric> = [Some(&quantity.metric), quantity.per.as_ref()]
        .into_iter()
        .flatten()
        .map(|m| Metric::named(m))
        .collect();
    let (mut cells, mut conditions, mut fault) = (Vec::new(), Vec::new(), None);
    for metric in &metrics {
        let mut found = bench.gather(std::slice::from_ref(cell), metric);
        for numbers in &mut found.numbers {
            numbers.cell = format!("{metric}: {}", numbers.cell);
        }
        cells.append(&mut found.numbers);
        conditions = found.conditions;
        fault = fault.or(found.groups.err());
    }
    let readings = |i: usize, metric: &Metric| -> Vec<f64> {
        bench.observations.readings(&[i], metric).values.into_iter().flatten().collect()
    };
    let parts = conditions.iter().map(|&i| {
        let amounts = readings(i, &metrics[0]);
        match metrics.get(1) {
            Some(per) => amounts.into_iter().zip(readings(i, per)).collect(),
            None => amounts.into_iter().map(|amount| (amount, 1.0)).collect(),
        }
    });
    let parts = parts.collect();
    Gathered { cells, conditions, parts: fault.map_or(Ok(parts), Err) }
}

fn compared(
    bench: &Bench<'_>,
    about: &str,
    form: &Rate,
    first: &[Vec<Part>],
    second: &[Vec<Part>],
) -> Result<Evidence, String> {
    let seen: Vec<Vec<f64>> =
        first.iter().map(|trials| (0..trials.len() as u64).map(real).collect()).collect();
    let rate = |parts: &[Vec<Part>], drawn: &[Vec<f64>]| {
        let (mut amount, mut per) = (0.0, 0.0);
        for (trials, places) in parts.iter().zip(drawn) {
            for &place in places {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a place among trials"
                )]
                let part = trials[place as usize];
                amount += part.0;
                per += part.1;
            }
        }
        amount / per
    };
    let rates = [rate(first, &seen), rate(second, &seen)];
    for (quantity, rate) in [&form.of, &form.than].into_iter().zip(rates) {
        if !rate.is_finite() {
            let per = quantity.per.as_deref().unwrap_or("trials");
            return Err(format!("there are no {per}, so {quantity} is no number"));
        }
    }
    let samples: Vec<&[f64]> = seen.iter().map(Vec::as_slice).collect();
    let found = bootstrap(
        &samples,
        |drawn| {
            let difference = rate(first, drawn) - rate(second, drawn);
            // A draw in which one of them is no number speaks for neither side.
            if difference.is_finite() { difference } else { 0.0 }
        },
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let resamples = real(found.statistics.len() as u64);
    let count = |holds: fn(f64) -> bool| {
        real(found.statistics.iter().filter(|&&x| holds(x)).count() as u64)
    };
    let share = |count: f64| (count + 1.0) / (resamples + 1.0);
    let tails = Tails {
        less: share(count(|x| x >= 0.0)),
        greater: share(count(|x| x <= 0.0)),
        two_sided: f64::NAN,
    };
    let (p_for, p_against) = directed(tails, found.estimate, form.direction, Sides::One);
    Ok(Evidence {
        p_for,
        p_against,
        statistics: vec![("first", rates[0]), ("second", rates[1]), ("resamples", resamples)],
        effect: Some(Effect {
            name: "rate-difference",
            value: found.estimate,
            interval: found.interval,
            standardised: None,
        }),
    })
}

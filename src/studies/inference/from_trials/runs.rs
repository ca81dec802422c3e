//! What our runs say of every cell: means by combination, and how single runs scatter about them.

use super::FromTrials;
use crate::stats::real;
use crate::studies::{Findings, Group};
use std::collections::{BTreeMap, BTreeSet};

/// Our runs of a design, as far as they say something of the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Runs {
    /// By cell: whether its arm was run at all, and the cell is not left out.
    pub counted: Vec<bool>,
    /// The combinations that were run in every arm that was.
    pub combinations: Vec<Combination>,
    /// By pair of cells: the relative covariance of single runs, pooled over the combinations.
    spread: Vec<f64>,
    /// By cell: whether any combination has two runs that reached it.
    known: Vec<bool>,
}

/// A combination of choices.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Combination {
    /// By choice: the index of its value.
    pub values: Vec<usize>,
    /// By cell: what our runs came to; `None` where none of them did.
    pub cells: Vec<Option<Reached>>,
    /// Runs of it, in all arms.
    pub runs: u64,
}

/// The runs that came to a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reached {
    /// Their mean, above 0.
    pub mean: f64,
    /// How many they are.
    pub n: u64,
}

/// By arm: a run's numbers, cell by cell of that arm.
type Recorded = BTreeMap<(Vec<usize>, usize), Vec<Vec<Option<f64>>>>;

impl Runs {
    /// Collects the runs of `findings`.
    pub(super) fn of(findings: &Findings<'_>, question: &FromTrials) -> Self {
        let cells = &question.observed.cells;
        let of_arm = |arm: usize| -> Vec<usize> {
            (0..cells.len()).filter(|cell| cells[*cell].arm == arm).collect()
        };
        let arms: Vec<Vec<usize>> = (0..question.observed.arms.len()).map(of_arm).collect();
        let mut recorded = Recorded::new();
        for group in findings.ledger.groups() {
            if let Some(key) = place(group, question) {
                let runs = numbers(group, question, &arms[key.1]);
                recorded.entry(key).or_default().extend(runs);
            }
        }
        let run: BTreeSet<usize> = recorded.keys().map(|(_, arm)| *arm).collect();
        let mut combinations: BTreeMap<Vec<usize>, (BTreeSet<usize>, Combination)> =
            BTreeMap::new();
        let mut sums = Sums::new(cells.len());
        for ((values, arm), runs) in &recorded {
            let blank =
                Combination { values: values.clone(), cells: vec![None; cells.len()], runs: 0 };
            let (seen, combination) =
                combinations.entry(values.clone()).or_insert_with(|| (BTreeSet::new(), blank));
            seen.insert(*arm);
            combination.runs += runs.len() as u64;
            for (at, cell) in arms[*arm].iter().enumerate() {
                combination.cells[*cell] = reached(runs.iter().filter_map(|run| run[at]));
            }
            sums.add(runs, &arms[*arm], &combination.cells);
        }
        let combinations = combinations.into_values();
        let whole = combinations.filter(|(seen, _)| *seen == run).map(|(_, own)| own).collect();
        let counted = cells.iter().map(|cell| run.contains(&cell.arm) && !cell.left_out).collect();
        let (spread, known) = sums.pooled();
        Self { counted, combinations: whole, spread, known }
    }

    /// Returns the relative covariance of single runs in two cells, 0 of cells in different arms; of a cell that no combination
    /// has two runs of, the `printed` one.
    pub(super) fn spread(&self, a: usize, b: usize, printed: impl Fn(usize) -> Option<f64>) -> f64 {
        match (a == b, self.known[a]) {
            (true, false) => printed(a).map_or(0.0, |sd| sd * sd),
            _ => self.spread[a * self.known.len() + b],
        }
    }

    /// Returns how runs in two cells correlate: 1 of a cell with itself, 0 where that is not known.
    pub(super) fn correlation(&self, a: usize, b: usize) -> f64 {
        if a == b {
            return 1.0;
        }
        let size = self.known.len();
        let roots = (self.spread[a * size + a] * self.spread[b * size + b]).sqrt();
        if roots > 0.0 { self.spread[a * size + b] / roots } else { 0.0 }
    }
}

/// Returns the combination and the arm of a condition; `None` where the table prints nothing of that arm.
fn place(group: &Group, question: &FromTrials) -> Option<(Vec<usize>, usize)> {
    let condition = group.condition();
    let arm = question.observed.arms.iter().position(|arm| condition.has_all(arm))?;
    let value = |choice: &super::Choice| {
        let own = condition.value(&choice.name)?;
        choice.values.iter().position(|value| value == own)
    };
    Some((question.choices.iter().map(value).collect::<Option<_>>()?, arm))
}

/// Returns the numbers of every run of `group` in the cells of its arm.
fn numbers(group: &Group, question: &FromTrials, cells: &[usize]) -> Vec<Vec<Option<f64>>> {
    let mut runs = vec![Vec::with_capacity(cells.len()); group.len()];
    for cell in cells {
        let measure = &question.observed.cells[*cell].measure;
        for (run, number) in runs.iter_mut().zip(group.column(measure)) {
            run.push(number);
        }
    }
    runs
}

/// Summarises numbers; `None` where there are none, or all are 0: of nothing there is no ratio.
fn reached(numbers: impl Iterator<Item = f64>) -> Option<Reached> {
    let (sum, n) = numbers.fold((0.0, 0_u64), |(sum, n), number| (sum + number, n + 1));
    (sum > 0.0).then(|| Reached { mean: sum / real(n), n })
}

/// Sums of products of relative deviations of runs from the mean of their own combination.
struct Sums {
    size: usize,
    products: Vec<f64>,
    freedom: Vec<u64>,
}

impl Sums {
    fn new(size: usize) -> Self {
        Self { size, products: vec![0.0; size * size], freedom: vec![0; size] }
    }

    fn add(&mut self, runs: &[Vec<Option<f64>>], cells: &[usize], means: &[Option<Reached>]) {
        for cell in cells {
            self.freedom[*cell] += means[*cell].map_or(0, |reached| reached.n - 1);
        }
        for run in runs {
            // A run that did not come there deviates by nothing, so that the sums stay those of a covariance.
            let deviations: Vec<f64> = cells
                .iter()
                .zip(run)
                .map(|(cell, number)| {
                    means[*cell].zip(*number).map_or(0.0, |(own, number)| number / own.mean - 1.0)
                })
                .collect();
            for (a, of_a) in cells.iter().zip(&deviations) {
                for (b, of_b) in cells.iter().zip(&deviations) {
                    self.products[a * self.size + b] += of_a * of_b;
                }
            }
        }
    }

    /// Returns the pooled covariances, and of which cells they are known.
    fn pooled(self) -> (Vec<f64>, Vec<bool>) {
        let Self { size, mut products, freedom } = self;
        for a in 0..size {
            for b in 0..size {
                let freedom = (real(freedom[a]) * real(freedom[b])).sqrt();
                let own = &mut products[a * size + b];
                *own = if freedom > 0.0 { *own / freedom } else { 0.0 };
            }
        }
        (products, freedom.into_iter().map(|freedom| freedom > 0).collect())
    }
}

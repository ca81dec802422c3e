//! The occupation-measure linear programme of a constrained MDP (Altman 1999, chapter 8; Dufour and Piunovskiy
//! 2013 for models in which some policies never arrive).
//!
//! ```text
//! variables      rho(x,a) >= 0                                                      every sure pair
//! minimise       sum rho(x,a) c(x,a)
//! flow rows      sum_a rho(x,a) - sum_(y,b) P(y,b,x) rho(y,b) = beta(x)             every reachable x outside M
//! bound rows     sum rho(x,a) c_i(x,a) + slack_i = D_i                              i = 1..L
//! ```
//!
//! Three scalings make it well behaved. A column stands for the expected number of *departures* by (x, a), not of
//! attempts: self-loops are folded by dividing the column by the exit probability, so that its own flow entry is
//! exactly 1 and the others sum to at least -1. A bound row is divided by its bound. And a column with entries above 1,
//! one whose single departure would exceed a bound, is divided by the largest.
//!
//! 1. Number the flow rows and set their right-hand sides, the initial distribution.
//! 2. Choose the pairs, one column each, and fold their self-loops into their costs.
//! 3. Scale criteria and bound rows.
//! 4. Write the columns: flow entries, then bound entries.
//! 5. Divide columns by their largest entry, and append the slacks.
//! 6. Scale the objectives like their columns, and refuse what has left the range of floating point.

use super::model::Cmdp;
use super::prune::Sure;

/// The programme in columns: first the pairs, then one slack per bound.
#[derive(Debug)]
pub(super) struct Programme {
    /// How many flow rows there are; bound row i is row `flow_rows + i`.
    pub(super) flow_rows: usize,
    /// Per column its nonzero entries, by ascending row.
    pub(super) columns: Vec<Vec<(usize, f64)>>,
    /// Per column, how many units of it make one departure: at least 1, so that no entry of a column is above
    /// 1 and a value next to zero is next to zero in every row.
    pub(super) unit: Vec<f64>,
    /// Per pair column, which pair of the model it is.
    pub(super) pairs: Vec<usize>,
    /// Right-hand sides.
    pub(super) rhs: Vec<f64>,
    /// Per criterion (primary, then secondaries) the scaled cost of each column.
    pub(super) objectives: Vec<Vec<f64>>,
    /// What each criterion was divided by in `objectives`.
    pub(super) objective_scale: Vec<f64>,
    /// What each bound row was divided by.
    pub(super) bound_scale: Vec<f64>,
}

/// A cost or a probability so extreme that the programme cannot be written in floating point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Overflow;

impl Programme {
    /// Writes the programme over the `reachable` states and `sure` pairs of `cmdp`, in the steps of the module
    /// documentation.
    pub(super) fn new(cmdp: &Cmdp, sure: &Sure, reachable: &[bool]) -> Result<Self, Overflow> {
        // 1. Flow rows.
        let mut row_of = vec![None; cmdp.states()];
        let mut flow_rows = 0;
        for x in (0..cmdp.states()).filter(|x| reachable[*x]) {
            row_of[x] = Some(flow_rows);
            flow_rows += 1;
        }
        let bounds = cmdp.secondary().len();
        let mut rhs = vec![0.0; flow_rows + bounds];
        for &(x, p) in cmdp.initial() {
            if let Some(row) = row_of[x] {
                rhs[row] = p;
            }
        }
        // 2. Pairs. One that only stays where it is belongs to no policy that arrives.
        let pairs: Vec<usize> = (0..cmdp.pairs().len())
            .filter(|i| sure.pairs[*i] && reachable[cmdp.pairs()[*i].state])
            .filter(|i| cmdp.pairs()[*i].exit() > 0.0)
            .collect();
        let folded: Vec<Vec<f64>> = pairs
            .iter()
            .map(|i| {
                let pair = &cmdp.pairs()[*i];
                let exit = pair.exit();
                pair.costs.iter().map(|c| c / exit).collect()
            })
            .collect();
        // 3. Scales.
        let largest = |k: usize| folded.iter().map(|c| c[k]).fold(0.0, f64::max);
        let positive_or_one = |x: f64| if x > 0.0 { x } else { 1.0 };
        let objective_scale: Vec<f64> = (0..=bounds).map(|k| positive_or_one(largest(k))).collect();
        let bound_scale: Vec<f64> = cmdp
            .secondary()
            .iter()
            .zip(&objective_scale[1..])
            .map(
                |(secondary, largest)| {
                    if secondary.bound > 0.0 { secondary.bound } else { *largest }
                },
            )
            .collect();
        for (i, secondary) in cmdp.secondary().iter().enumerate() {
            rhs[flow_rows + i] = secondary.bound / bound_scale[i];
        }

        // 4. Columns.
        let mut columns = Vec::with_capacity(pairs.len() + bounds);
        for (i, costs) in pairs.iter().zip(&folded) {
            let pair = &cmdp.pairs()[*i];
            let exit = pair.exit();
            let mut column: Vec<(usize, f64)> = pair
                .elsewhere()
                .filter_map(|(y, p)| row_of[y].map(|row| (row, -p / exit)))
                .chain(row_of[pair.state].map(|row| (row, 1.0)))
                .collect();
            column.sort_unstable_by_key(|(row, _)| *row);
            for (k, scale) in bound_scale.iter().enumerate() {
                if costs[k + 1] > 0.0 {
                    column.push((flow_rows + k, costs[k + 1] / scale));
                }
            }
            columns.push(column);
        }
        // 5. Units of columns, and slacks.
        let mut unit: Vec<f64> = columns
            .iter_mut()
            .map(|column: &mut Vec<(usize, f64)>| {
                let unit = column.iter().fold(1.0_f64, |largest, (_, entry)| largest.max(*entry));
                for (_, entry) in column.iter_mut() {
                    *entry /= unit;
                }
                unit
            })
            .collect();
        unit.resize(columns.len() + bounds, 1.0);
        columns.extend((0..bounds).map(|i| vec![(flow_rows + i, 1.0)]));
        // 6. Objectives.
        let objectives: Vec<Vec<f64>> = objective_scale
            .iter()
            .enumerate()
            .map(|(k, scale)| {
                let slacks = std::iter::repeat_n(0.0, bounds);
                let costs = folded.iter().zip(&unit).map(|(c, unit)| c[k] / scale / unit);
                costs.chain(slacks).collect()
            })
            .collect();
        let finite = columns.iter().flatten().all(|(_, value)| value.is_finite())
            && objectives.iter().flatten().all(|value| value.is_finite())
            && objective_scale.iter().chain(&bound_scale).all(|scale| scale.is_finite());
        if !finite {
            return Err(Overflow);
        }
        Ok(Self { flow_rows, columns, unit, pairs, rhs, objectives, objective_scale, bound_scale })
    }

    /// Returns how many rows there are.
    pub(super) fn rows(&self) -> usize {
        self.rhs.len()
    }

    /// Returns the column of the slack of bound `i`.
    pub(super) fn slack(&self, i: usize) -> usize {
        self.pairs.len() + i
    }
}

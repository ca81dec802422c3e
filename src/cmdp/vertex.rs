//! From an interior point to a vertex of the programme, and from vertex to better vertex.
//!
//! *Purification* walks from the interior point to a basic solution that is no worse (Megiddo 1991, "On finding primal-
//! and dual-optimal bases"; the primal push of Bixby and Saltzman 1994). *Pivoting* is the primal simplex method from
//! there: mostly it only certifies that no reduced cost is negative. It also answers what an interior point cannot:
//! which bound cannot be met and what total is least, exactly at the knife edge, and what is best on the optimal face
//! by the next criterion.
//!
//! Purification:
//! 1. Factor a basis from independent columns, the heaviest first.
//! 2. Give columns outside of it that carry mass their interior values.
//! 3. Push them to zero one by one, or swap them in where a basic column reaches zero first.
//! 4. Factor afresh, and check that no basic value is negative.
//!
//! Pivoting repeats:
//! 1. Stop where the bound to be imposed holds.
//! 2. Price: find a column of negative reduced cost. Where there is none with a fresh inverse either, the vertex is
//!    optimal.
//! 3. Ratio test: find the row whose column leaves, and the step.
//! 4. Pivot, and factor afresh every fifty pivots.

use super::basis::Basis;
use super::occupation::Programme;

/// A reduced cost this far below zero, relative to the terms whose difference it is, calls for a pivot.
const OPTIMALITY: f64 = 1e-12;
/// The same for calling a column strictly worse than the optimal face.
const STRICTLY_WORSE: f64 = 1e-11;
/// After long stalling a reduced cost this small counts as zero.
const FORGIVEN: f64 = 1e-9;
/// Entries of a direction this small, relative to its largest, are rounding.
const ENTRY: f64 = 1e-13;
/// How far from dependent, relative to the largest entry of its direction, a column is taken into the first
/// basis.
const INDEPENDENT: f64 = 1e-9;
/// How far below zero, relative to the largest, a basic value may be.
const FEASIBILITY: f64 = 1e-11;
/// Mass of the interior point below which a column is simply set to zero.
const NEGLIGIBLE: f64 = 1e-8;
/// How small, relative to the largest multiplier, the terms of a reduced cost may be to count in full.
const FLOOR: f64 = 1e-3;
/// Pivots between two fresh factorisations.
const FRESH: usize = 50;

/// Pivoting did not end: rounding has eaten the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stalled;

/// A basic solution of the programme. Nonbasic columns are zero.
#[derive(Debug)]
pub(super) struct Vertex<'a> {
    programme: &'a Programme,
    basis: Basis,
    /// By row, the value of its basic column.
    values: Vec<f64>,
    /// By column, the row in which it is basic.
    row_of: Vec<Option<usize>>,
    /// By column: may take either sign (the slack of a bound that is not imposed).
    free: Vec<bool>,
    /// By column: held at zero, because it leads off the optimal face of an earlier criterion.
    banned: Vec<bool>,
    /// How many pivots were made, pushes included.
    pub(super) pivots: usize,
}

/// The result of minimising a criterion.
#[derive(Debug)]
pub(super) struct Optimum {
    /// The multiplier of each bound row, at most 0, in the programme's scaling.
    pub(super) bound_multipliers: Vec<f64>,
    /// Columns whose reduced cost is clearly positive.
    worse: Vec<usize>,
}

impl<'a> Vertex<'a> {
    /// Creates the vertex of a policy that surely arrives, `choice` being one pair column per flow row. No bound is
    /// imposed yet.
    pub(super) fn of_policy(programme: &'a Programme, choice: &[usize]) -> Option<Self> {
        let bounds = programme.rows() - programme.flow_rows;
        let offered = choice.iter().copied().chain((0..bounds).map(|i| programme.slack(i)));
        let basis = Basis::factor(programme, offered, 0.0)?;
        let mut vertex = Self::at(programme, basis);
        for i in 0..bounds {
            vertex.free[programme.slack(i)] = true;
        }
        Some(vertex)
    }

    /// Purifies the interior point `interior` (a value per column). All bounds are imposed. `None` where
    /// rounding leaves no vertex that meets them.
    pub(super) fn of_interior(programme: &'a Programme, interior: &[f64]) -> Option<Self> {
        // 1. A basis of the heaviest columns.
        let mut order: Vec<usize> = (0..interior.len()).collect();
        order.sort_by(|a, b| interior[*b].total_cmp(&interior[*a]).then(a.cmp(b)));
        let basis = Basis::factor(programme, order.iter().copied(), INDEPENDENT)?;
        let mut vertex = Self::at(programme, basis);
        // 2. Columns outside the basis that carry mass keep it ...
        let extra: Vec<usize> = order
            .into_iter()
            .filter(|j| vertex.row_of[*j].is_none() && interior[*j] > NEGLIGIBLE)
            .collect();
        for &j in &extra {
            for (value, step) in
                vertex.values.iter_mut().zip(vertex.basis.direction(&programme.columns[j]))
            {
                *value -= interior[j] * step;
            }
        }
        // 3. ... until they are pushed to zero one by one.
        for j in extra {
            vertex.push_to_zero(j, interior[j]);
        }
        // 4. Fresh values.
        vertex.refresh(0.0)?;
        let tolerance = FEASIBILITY * vertex.largest_value();
        vertex.values.iter().all(|x| *x >= -tolerance).then_some(vertex)
    }

    fn at(programme: &'a Programme, basis: Basis) -> Self {
        let columns = programme.columns.len();
        let mut row_of = vec![None; columns];
        for (row, column) in basis.basic.iter().enumerate() {
            row_of[*column] = Some(row);
        }
        let values = basis.solve(programme, &programme.rhs);
        Self {
            programme,
            basis,
            values,
            row_of,
            free: vec![false; columns],
            banned: vec![false; columns],
            pivots: 0,
        }
    }

    /// Returns the expected number of departures by every pair column, and the slacks.
    pub(super) fn columns(&self) -> Vec<f64> {
        let value = |row: &Option<usize>| row.map_or(0.0, |row| self.values[row].max(0.0));
        self.row_of.iter().zip(&self.programme.unit).map(|(row, unit)| value(row) / unit).collect()
    }

    /// Returns whether `column` is basic: only then can its value be positive.
    pub(super) fn is_basic(&self, column: usize) -> bool {
        self.row_of[column].is_some()
    }

    /// Returns what is left of bound `i`, in units of its row's scale; negative where it is exceeded.
    pub(super) fn slack(&self, i: usize) -> f64 {
        self.row_of[self.programme.slack(i)].map_or(0.0, |row| self.values[row])
    }

    /// Lowers the total of bound `i` until the bound holds, or as far as it can be lowered while the bounds
    /// already imposed hold. Imposes the bound in the first case; in the second returns the optimum.
    pub(super) fn impose(&mut self, i: usize) -> Result<Option<Optimum>, Stalled> {
        let slack = self.programme.slack(i);
        let row = self.programme.flow_rows + i;
        let mut totals = vec![0.0; self.programme.columns.len()];
        for (cost, column) in totals.iter_mut().zip(&self.programme.columns[..slack - i]) {
            *cost = column.iter().find(|(r, _)| *r == row).map_or(0.0, |(_, value)| *value);
        }
        let optimum = self.minimise(&totals, Some(slack))?;
        if optimum.is_none() {
            self.free[slack] = false;
        }
        Ok(optimum)
    }

    /// Stops trying to impose bound `i`: its row is only bookkeeping from here on.
    pub(super) fn release(&mut self, i: usize) {
        self.free[self.programme.slack(i)] = true;
    }

    /// Minimises `costs` and stays on the optimal face from then on.
    pub(super) fn optimise(&mut self, costs: &[f64]) -> Result<Optimum, Stalled> {
        let optimum = self.minimise(costs, None)?.ok_or(Stalled)?;
        self.keep_to(&optimum);
        Ok(optimum)
    }

    /// Holds at zero every column that would lead off the optimal face.
    pub(super) fn keep_to(&mut self, optimum: &Optimum) {
        for &column in &optimum.worse {
            self.banned[column] = true;
        }
    }

    /// Runs the primal simplex method: largest violation first, the smallest index (Bland 1977) after a stall.
    ///
    /// With `until`, a slack that is free and negative, ends without an optimum as soon as it is not negative.
    fn minimise(
        &mut self,
        costs: &[f64],
        until: Option<usize>,
    ) -> Result<Option<Optimum>, Stalled> {
        let size = self.programme.rows() + self.programme.columns.len();
        let patience = 100 + 4 * size;
        let limit = 1000 + 100 * size;
        let mut stalled = 0;
        let mut fresh = false;
        for _ in 0..limit {
            // 1. Does the bound hold?
            let restored =
                until.filter(|slack| self.row_of[*slack].is_none_or(|row| self.values[row] >= 0.0));
            if restored.is_some() {
                return Ok(None);
            }
            // 2. Price.
            let y = self.basis.multipliers(self.programme, costs);
            let tolerance = if stalled > 2 * patience { FORGIVEN } else { OPTIMALITY };
            let Some(entering) = self.entering(costs, &y, tolerance, stalled > patience) else {
                // Optimal by the running inverse; price once more with a fresh one.
                if fresh {
                    return Ok(Some(self.optimum(costs, &y)));
                }
                self.refresh(0.0).ok_or(Stalled)?;
                fresh = true;
                continue;
            };
            fresh = false;
            // 3. Ratio test.
            let direction = self.basis.direction(&self.programme.columns[entering]);
            let (row, step) = self.leaving(&direction, until, stalled > patience).ok_or(Stalled)?;
            stalled = if step > 0.0 { 0 } else { stalled + 1 };
            // 4. Pivot.
            self.pivot(row, entering, &direction, -step, step);
            if self.pivots.is_multiple_of(FRESH) {
                self.refresh(0.0).ok_or(Stalled)?;
            }
        }
        Err(Stalled)
    }

    /// Computes the reduced cost of a column and the size of the terms of which it is made, with a floor: what is
    /// exactly zero comes out as rounding of the largest multiplier.
    fn reduced_cost(&self, column: usize, costs: &[f64], y: &[f64], floor: f64) -> (f64, f64) {
        let (mut reduced, mut scale) = (costs[column], costs[column].abs());
        for (row, entry) in &self.programme.columns[column] {
            let term = y[*row] * entry;
            reduced -= term;
            scale += term.abs();
        }
        // A slack is measured in bounds, a whole one of which counts next to the total.
        let share = if column < self.programme.pairs.len() {
            FLOOR / self.programme.unit[column]
        } else {
            1.0
        };
        (reduced, scale.max(share * floor))
    }

    /// Returns the size of the numbers of which multipliers are made: the largest expected total from any state, or
    /// basic cost, as the former may cancel.
    fn magnitude(&self, costs: &[f64], y: &[f64]) -> f64 {
        let basic = self.basis.basic.iter().map(|j| costs[*j] * self.programme.unit[*j]);
        let totals = y[..self.programme.flow_rows].iter().copied();
        basic.chain(totals).fold(0.0, |largest, x| largest.max(x.abs()))
    }

    fn entering(&self, costs: &[f64], y: &[f64], tolerance: f64, bland: bool) -> Option<usize> {
        let floor = self.magnitude(costs, y);
        let mut best = (0.0, None);
        for column in 0..self.programme.columns.len() {
            if self.row_of[column].is_some() || self.banned[column] {
                continue;
            }
            let (reduced, scale) = self.reduced_cost(column, costs, y, floor);
            if reduced < -tolerance * scale && reduced < best.0 {
                best = (reduced, Some(column));
                if bland {
                    break;
                }
            }
        }
        best.1
    }

    /// Finds the row whose column leaves, and how far the entering one can rise. In two passes (Harris 1973): first how
    /// far with a little slack, then the largest pivot within that.
    fn leaving(
        &self,
        direction: &[f64],
        until: Option<usize>,
        bland: bool,
    ) -> Option<(usize, f64)> {
        let largest = direction.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let smallest = ENTRY * largest;
        let forgiven = if bland { 0.0 } else { 1e-13 * self.largest_value() };
        let ratio = |row: usize, forgiven: f64| {
            let (value, fall) = (self.values[row], direction[row]);
            let column = self.basis.basic[row];
            if Some(column) == until {
                (fall < -smallest).then(|| (value - forgiven) / fall)
            } else if self.free[column] {
                None
            } else {
                (fall > smallest).then(|| (value.max(0.0) + forgiven) / fall)
            }
        };
        let furthest = (0..direction.len())
            .filter_map(|row| ratio(row, forgiven))
            .fold(f64::INFINITY, f64::min);
        let candidates = (0..direction.len())
            .filter_map(|row| ratio(row, 0.0).filter(|r| *r <= furthest).map(|r| (row, r)));
        if bland {
            candidates.min_by_key(|(row, _)| self.basis.basic[*row])
        } else {
            candidates.max_by(|(a, _), (b, _)| {
                let order = direction[*a].abs().total_cmp(&direction[*b].abs());
                order.then(self.basis.basic[*b].cmp(&self.basis.basic[*a]))
            })
        }
    }

    /// Lowers a nonbasic column from `value` to zero, or swaps it in where a basic one reaches zero first.
    fn push_to_zero(&mut self, column: usize, value: f64) {
        let direction = self.basis.direction(&self.programme.columns[column]);
        let largest = direction.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let mut block = (value, None);
        for (row, rise) in direction.iter().enumerate() {
            if *rise < -ENTRY * largest {
                let reach = self.values[row].max(0.0) / -rise;
                let steeper =
                    block.1.is_some_and(|b: usize| reach == block.0 && rise < &direction[b]);
                if reach < block.0 || steeper {
                    block = (reach, Some(row));
                }
            }
        }
        match block {
            (step, Some(row)) => self.pivot(row, column, &direction, step, value - step),
            (step, None) => {
                for (x, rise) in self.values.iter_mut().zip(&direction) {
                    *x += step * rise;
                }
            }
        }
    }

    /// Moves all basic values by `step` along `direction` and makes `column` basic in `row` at `value`.
    fn pivot(&mut self, row: usize, column: usize, direction: &[f64], step: f64, value: f64) {
        for (x, d) in self.values.iter_mut().zip(direction) {
            *x += step * d;
        }
        self.row_of[self.basis.basic[row]] = None;
        self.row_of[column] = Some(row);
        self.values[row] = value;
        self.basis.replace(row, column, direction);
        self.pivots += 1;
    }

    /// Factors the basis afresh and recomputes the values.
    fn refresh(&mut self, smallest: f64) -> Option<()> {
        let columns = self.basis.basic.clone();
        self.basis = Basis::factor(self.programme, columns, smallest)?;
        for (row, column) in self.basis.basic.iter().enumerate() {
            self.row_of[*column] = Some(row);
        }
        self.values = self.basis.solve(self.programme, &self.programme.rhs);
        Some(())
    }

    fn optimum(&self, costs: &[f64], y: &[f64]) -> Optimum {
        let floor = self.magnitude(costs, y);
        let worse = (0..self.programme.columns.len())
            .filter(|column| self.row_of[*column].is_none())
            .filter(|column| {
                let (reduced, scale) = self.reduced_cost(*column, costs, y, floor);
                reduced > STRICTLY_WORSE * scale
            })
            .collect();
        Optimum { bound_multipliers: y[self.programme.flow_rows..].to_vec(), worse }
    }

    fn largest_value(&self) -> f64 {
        self.values.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()))
    }
}

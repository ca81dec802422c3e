//! A basis of the programme: as many independent columns as there are rows, with their inverse.
//!
//! The inverse is dense and explicit. At the sizes of this planner (a map of up to a few hundred vertices)
//! that is fast enough, and simple enough to read.

use super::occupation::Programme;

/// A row that no column covers yet.
const UNCOVERED: usize = usize::MAX;

/// A sum this small, relative to the sum of its terms' sizes, is zero.
const ROUNDING: f64 = 1e-13;

/// Columns B of a programme, one for each row, and B⁻¹.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    /// Per row, the basic column that is solved for in it.
    pub(super) basic: Vec<usize>,
    /// B⁻¹ by rows.
    inverse: Vec<f64>,
}

impl Basis {
    /// Factors the first independent columns among those offered, by elimination; `None` where they do not span.
    ///
    /// `smallest` is how far, relative to its largest entry, a reduced column's pivot may be from zero.
    pub(super) fn factor(
        programme: &Programme,
        offered: impl IntoIterator<Item = usize>,
        smallest: f64,
    ) -> Option<Self> {
        let rows = programme.rows();
        let mut inverse = vec![0.0; rows * rows];
        for row in 0..rows {
            inverse[row * rows + row] = 1.0;
        }
        let mut basis = Self { basic: vec![UNCOVERED; rows], inverse };
        let mut missing = rows;
        for column in offered {
            if missing == 0 {
                break;
            }
            let direction = basis.direction(&programme.columns[column]);
            let largest = direction.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            let mut pivot = (0.0, UNCOVERED);
            for (row, x) in direction.iter().enumerate() {
                if basis.basic[row] == UNCOVERED && x.abs() > pivot.0 {
                    pivot = (x.abs(), row);
                }
            }
            if pivot.1 != UNCOVERED && pivot.0 > smallest * largest {
                basis.replace(pivot.1, column, &direction);
                missing -= 1;
            }
        }
        (missing == 0).then_some(basis)
    }

    /// Computes B⁻¹ a for a sparse column a. Entries that are nothing but cancelled rounding are zero: rows have scales
    /// of their own, so that only the terms of an entry show how small it may be.
    pub(super) fn direction(&self, column: &[(usize, f64)]) -> Vec<f64> {
        let rows = self.basic.len();
        self.inverse
            .chunks_exact(rows.max(1))
            .map(|line| {
                let (mut sum, mut size) = (0.0_f64, 0.0);
                for (row, value) in column {
                    let term = line[*row] * value;
                    sum += term;
                    size += term.abs();
                }
                if sum.abs() > ROUNDING * size { sum } else { 0.0 }
            })
            .collect()
    }

    /// Replaces the basic column of `row` by `column`; `direction` is B⁻¹ of the new column.
    pub(super) fn replace(&mut self, row: usize, column: usize, direction: &[f64]) {
        let rows = self.basic.len();
        self.basic[row] = column;
        let pivot = direction[row];
        let line: Vec<f64> =
            self.inverse[row * rows..(row + 1) * rows].iter().map(|x| x / pivot).collect();
        for (other, target) in self.inverse.chunks_exact_mut(rows).enumerate() {
            if other == row {
                target.copy_from_slice(&line);
            } else if direction[other] != 0.0 {
                for (x, y) in target.iter_mut().zip(&line) {
                    *x -= direction[other] * y;
                }
            }
        }
    }

    /// Computes B⁻¹ b, with one step of iterative refinement.
    pub(super) fn solve(&self, programme: &Programme, rhs: &[f64]) -> Vec<f64> {
        let mut solution = self.multiply(rhs);
        let mut residual = rhs.to_vec();
        for (value, column) in solution.iter().zip(&self.basic) {
            for (row, entry) in &programme.columns[*column] {
                residual[*row] -= entry * value;
            }
        }
        for (value, correction) in solution.iter_mut().zip(self.multiply(&residual)) {
            *value += correction;
        }
        solution
    }

    /// Computes the multipliers y of the rows: y B = the basic columns' costs, with one step of refinement.
    pub(super) fn multipliers(&self, programme: &Programme, costs: &[f64]) -> Vec<f64> {
        let basic_costs: Vec<f64> = self.basic.iter().map(|column| costs[*column]).collect();
        let mut y = self.multiply_transposed(&basic_costs);
        let residual: Vec<f64> = self
            .basic
            .iter()
            .zip(&basic_costs)
            .map(|(column, cost)| {
                let column = &programme.columns[*column];
                cost - column.iter().map(|(row, entry)| y[*row] * entry).sum::<f64>()
            })
            .collect();
        for (value, correction) in y.iter_mut().zip(self.multiply_transposed(&residual)) {
            *value += correction;
        }
        y
    }

    fn multiply(&self, vector: &[f64]) -> Vec<f64> {
        self.inverse
            .chunks_exact(self.basic.len().max(1))
            .map(|line| line.iter().zip(vector).map(|(a, b)| a * b).sum())
            .collect()
    }

    fn multiply_transposed(&self, vector: &[f64]) -> Vec<f64> {
        let rows = self.basic.len();
        let mut product = vec![0.0; rows];
        for (line, weight) in self.inverse.chunks_exact(rows.max(1)).zip(vector) {
            if *weight != 0.0 {
                for (x, y) in product.iter_mut().zip(line) {
                    *x += weight * y;
                }
            }
        }
        product
    }
}

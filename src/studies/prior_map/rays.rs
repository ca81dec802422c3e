//! Rays that the authors' released program samples its gain with (prior-map facts, section 6), walked over a grid of what
//! each cell does to a ray.

use crate::grid::Cell;
use crate::math;

/// Set in the state of a cell that ends rays before it.
pub(super) const STOPS: u8 = 2;
/// Set in the state of a cell that counts where a ray meets it.
pub(super) const UNKNOWN: u8 = 1;

/// How many cells are looked at together for one that ends the ray.
const LOT: usize = 8;

/// The rays of one range: one at every whole degree from 0 to 360, so that the first and the last are the same. Of rays that
/// end in one cell one is kept: they are the same.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    range: i32,
    /// The offsets of all cells of all rays outwards, ray after ray.
    cells: Vec<Cell>,
    /// Where each of `cells` is in `rays` and how far out there, sorted by its place in the square around the disc; and where
    /// the part of each place begins.
    crossings: Vec<Crossing>,
    places: Vec<u32>,
    /// For each of `cells` its number among the cells that may be of several rays; beyond the last of these 0.
    numbers: Vec<u32>,
    parts: Vec<Ray>,
    /// How many cells may be of several rays.
    shared: u32,
    /// The width of the grid over which rays were walked last, and how far each of `cells` lies from p in it.
    width: usize,
    steps: Vec<isize>,
    /// Which of the shared cells a ray met.
    met: Vec<bool>,
}

/// A cell of a ray.
#[derive(Debug, Clone, Copy, Default)]
struct Crossing {
    ray: u16,
    step: u16,
}

/// A ray: a part of all cells.
#[derive(Debug, Clone, Copy)]
struct Ray {
    first: usize,
    /// From here on no cell is of another ray too.
    alone: usize,
    end: usize,
}

impl Rays {
    /// Creates rays of `range` cells: the end point is rounded to a cell, and a ray takes one cell per step along its
    /// longer axis.
    pub(super) fn new(range: i32) -> Self {
        let mut ends: Vec<Cell> = Vec::new();
        for degrees in 0..=360_u32 {
            let (sin, cos) = math::sin_cos(f64::from(degrees).to_radians());
            #[expect(clippy::cast_possible_truncation, reason = "within the range")]
            let end = |share: f64| (share * f64::from(range)).round() as i32;
            let end = Cell::new(end(cos), end(sin));
            if !ends.contains(&end) {
                ends.push(end);
            }
        }
        let (mut cells, mut rays) = (Vec::new(), Vec::new());
        for end in ends {
            let first = cells.len();
            let steps = end.x.abs().max(end.y.abs());
            cells.extend(
                (0..=steps)
                    .map(|step| Cell::new(along(end.x, step, steps), along(end.y, step, steps))),
            );
            rays.push(Ray { first, alone: first, end: cells.len() });
        }
        let mut all = Self {
            range,
            numbers: vec![0; cells.len()],
            cells,
            crossings: Vec::new(),
            places: Vec::new(),
            parts: rays,
            shared: 0,
            width: 0,
            steps: Vec::new(),
            met: Vec::new(),
        };
        all.number();
        all
    }

    /// Finds the cells that are of several rays, and numbers them and those of the same rays before them.
    fn number(&mut self) {
        let squares = self.place(Cell::new(self.range, self.range)).map_or(0, |last| last + 1);
        let places: Vec<usize> = self.cells.iter().filter_map(|&cell| self.place(cell)).collect();
        self.places = vec![0; squares + 1];
        for &place in &places {
            self.places[place + 1] += 1;
        }
        for place in 0..squares {
            self.places[place + 1] += self.places[place];
        }
        let mut next = self.places.clone();
        self.crossings = vec![Crossing::default(); self.cells.len()];
        for (number, ray) in (0..).zip(&self.parts) {
            for (step, &place) in (0..).zip(&places[ray.first..ray.end]) {
                self.crossings[next[place] as usize] = Crossing { ray: number, step };
                next[place] += 1;
            }
        }
        let mut numbers: Vec<Option<u32>> = vec![None; squares];
        for ray in &mut self.parts {
            let uses = |place: &usize| self.places[place + 1] - self.places[*place];
            let last = places[ray.first..ray.end].iter().rposition(|place| uses(place) > 1);
            ray.alone = ray.first + last.map_or(0, |last| last + 1);
            for i in ray.first..ray.alone {
                self.numbers[i] = *numbers[places[i]].get_or_insert_with(|| {
                    self.shared += 1;
                    self.shared - 1
                });
            }
        }
        self.met = vec![false; self.shared as usize];
    }

    /// Returns the number of the cell that is `offset` from p in the square around the disc.
    fn place(&self, offset: Cell) -> Option<usize> {
        let side = 2 * self.range + 1;
        let (x, y) = (offset.x + self.range, offset.y + self.range);
        let is_within = (0..side).contains(&x) && (0..side).contains(&y);
        is_within.then(|| usize::try_from(y * side + x).unwrap_or(usize::MAX))
    }

    /// Returns whether rays of which the first cells, as many as `looked_at` says of each, decided a gain looked at the cell
    /// `offset` from p.
    pub(super) fn look_at(&self, offset: Cell, looked_at: &[u16]) -> bool {
        self.place(offset).is_some_and(|place| {
            let crossings = self.places[place] as usize..self.places[place + 1] as usize;
            let is_seen =
                |crossing: &Crossing| crossing.step < looked_at[usize::from(crossing.ray)];
            self.crossings[crossings].iter().any(is_seen)
        })
    }

    /// Prepares for grids whose rows are `width` cells long.
    fn lay_over(&mut self, width: usize) {
        if self.width != width {
            self.width = width;
            let width = isize::try_from(width).unwrap_or(0);
            let offset = |cells: i32| isize::try_from(cells).unwrap_or(0);
            let step = |cell: &Cell| offset(cell.y) * width + offset(cell.x);
            self.steps.clear();
            self.steps.extend(self.cells.iter().map(step));
        }
    }

    /// Counts the distinct unknown cells that rays from the cell `p` of `states` meet before one that stops them, and says how
    /// many cells of each ray decided that. The rows of the states, `width` cells long, hold all cells within the range.
    pub(super) fn unknown(&mut self, states: &[u8], width: usize, p: usize) -> (u32, Box<[u16]>) {
        self.lay_over(width);
        self.met.fill(false);
        let mut unknown = 0;
        let state = |step: &isize| states[p.wrapping_add_signed(*step)];
        let looked_at = self.parts.iter().map(|ray| {
            let Ray { first, alone, end } = *ray;
            let mut looked_at = 0;
            for (step, &number) in self.steps[first..alone].iter().zip(&self.numbers[first..]) {
                looked_at += 1;
                let state = state(step);
                if state & STOPS != 0 {
                    return looked_at;
                }
                let met = &mut self.met[number as usize];
                unknown += u32::from(state & UNKNOWN & u8::from(!*met));
                *met = true;
            }
            for lot in self.steps[alone..end].chunks(LOT) {
                let (any, sum) = lot.iter().map(state).fold((0, 0), |(any, sum), state| {
                    (any | state, sum + u32::from(state & UNKNOWN))
                });
                if any & STOPS != 0 {
                    for state in lot.iter().map(state) {
                        looked_at += 1;
                        if state & STOPS != 0 {
                            return looked_at;
                        }
                        unknown += u32::from(state & UNKNOWN);
                    }
                }
                looked_at += u16::try_from(lot.len()).unwrap_or(0);
                unknown += sum;
            }
            looked_at
        });
        let looked_at = looked_at.collect();
        (unknown, looked_at)
    }
}

/// Returns the coordinate after `step` of `steps` steps towards `end`, rounded to the nearest cell, halves away from
/// zero.
fn along(end: i32, step: i32, steps: i32) -> i32 {
    if steps == 0 { 0 } else { (2 * end.abs() * step + steps) / (2 * steps) * end.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn cells(rays: &Rays, ray: Ray) -> &[Cell] {
        &rays.cells[ray.first..ray.end]
    }

    proptest! {
        /// Checks that every ray is a chain of neighbours that leaves none out and ends within half a cell of the
        /// range, and that there is one towards every degree.
        #[test]
        fn rays_are_chains(range in 1..120_i32) {
            let rays = Rays::new(range);
            let mut ends = BTreeSet::new();
            for &ray in &rays.parts {
                let ray = cells(&rays, ray);
                prop_assert_eq!(ray[0], Cell::new(0, 0));
                prop_assert!(ray.windows(2).all(|w| w[0].neighbours8().contains(&w[1])));
                let end = *ray.last().unwrap();
                let length = math::hypot(f64::from(end.x), f64::from(end.y));
                prop_assert!((length - f64::from(range)).abs() <= std::f64::consts::FRAC_1_SQRT_2);
                ends.insert(end);
            }
            prop_assert_eq!(ends.len(), rays.parts.len(), "no ray is there twice");
            let half = f64::from(range) / 2.0;
            for degrees in 0..360_u32 {
                let (sin, cos) = math::sin_cos(f64::from(degrees).to_radians());
                let near = |end: &Cell| math::hypot(f64::from(end.x) - 2.0 * half * cos, f64::from(end.y) - 2.0 * half * sin);
                prop_assert!(ends.iter().any(|end| near(end) <= 0.708));
            }
        }

        /// Checks that as many cells are met as walking every ray by itself meets, and that the cells that no ray looked at
        /// decide nothing.
        #[test]
        fn cells_are_met_as_ray_by_ray(
            range in 1..30_i32,
            strewn in prop::collection::vec((0..80_usize * 80, 0_u8..4), 0..300),
            others in prop::collection::vec((0..80_usize * 80, 0_u8..4), 0..60),
            free: bool,
        ) {
            let (width, p) = (80, 40 * 80 + 40);
            let mut states = vec![if free { 0 } else { UNKNOWN }; width * 80];
            for (place, state) in strewn {
                states[place] = state;
            }
            let mut rays = Rays::new(range);
            let (found, looked_at) = rays.unknown(&states, width, p);
            let mut met = BTreeSet::new();
            for degrees in 0..=360_u32 {
                let (sin, cos) = math::sin_cos(f64::from(degrees).to_radians());
                #[expect(clippy::cast_possible_truncation, reason = "within the range")]
                let end = |share: f64| (share * f64::from(range)).round() as i32;
                let (x, y) = (end(cos), end(sin));
                let steps = x.abs().max(y.abs());
                for step in 0..=steps {
                    let cell = Cell::new(40 + along(x, step, steps), 40 + along(y, step, steps));
                    let place = usize::try_from(cell.y * 80 + cell.x).unwrap();
                    if states[place] & STOPS != 0 {
                        break;
                    }
                    if states[place] & UNKNOWN != 0 {
                        met.insert(place);
                    }
                }
            }
            prop_assert_eq!(found as usize, met.len());
            let mut elsewhere = states;
            for (place, state) in others {
                let at = |v: usize| i32::try_from(v).unwrap() - 40;
                if !rays.look_at(Cell::new(at(place % 80), at(place / 80)), &looked_at) {
                    elsewhere[place] = state;
                }
            }
            prop_assert_eq!(rays.unknown(&elsewhere, width, p), (found, looked_at));
        }
    }
}

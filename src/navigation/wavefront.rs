//! Distances to a goal over the inflated map, and the descent to it.

use super::CostGrid;
use super::costmap::{padded_index, padded_len, padded_width};
use super::inflated_map::{Ground, InflatedMap, Moment};
use crate::grid::{Cell, GridFrame};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Value of cells the wave did not reach.
pub const UNREACHED: u32 = u32::MAX;

/// A straight step's plain length in the wave's units; a diagonal one is 1.4 times that.
const STRAIGHT: u32 = 10;
const DIAGONAL: u32 = 14;

/// Half the side of the box around a goal that cannot be crossed (cells).
const BOX: i32 = 5;

/// Weighted distances from cells to one goal (Dijkstra 1959, with the buckets of Dial 1969), 8-connected over known cells
/// below a lethal cost: a step costs its length x (1 + weight x cost / 100).
///
/// The wave spreads only as far as requested. Its answers do not depend on that: a distance is returned once it is
/// final.
#[derive(Debug, Clone)]
pub struct Wavefront {
    costs: Arc<CostGrid>,
    moment: Option<Moment>,
    goal: Cell,
    lethal: u8,
    weight: f64,
    /// Padded as the costs are; final where below `level`.
    distances: Vec<u32>,
    /// Cost of a step into a cell of each cost, straight and diagonally.
    straight: Vec<u32>,
    diagonal: Vec<u32>,
    /// Cells (padded indices) by their distance at the time, modulo the number of buckets: a power of two, above the
    /// longest step.
    buckets: Vec<Vec<u32>>,
    /// Cells that have a distance, to be forgotten when the memory is used again.
    reached: Vec<u32>,
    /// Cells in all buckets.
    waiting: usize,
    level: u32,
    /// Wave units per metre of plain length.
    units_per_metre: f64,
}

/// A wave that has let go of its costs, so that they can be changed in place.
#[derive(Debug)]
pub struct RestingWave(Wavefront);

impl Wavefront {
    /// Starts the wave from `goal` over `costs`, crossing cells cheaper than `lethal`. Where the goal itself is not
    /// crossable, all crossable cells in the 11-cell box around it are seeds instead.
    pub fn from_goal(ground: impl Into<Ground>, goal: Cell, lethal: u8, weight: f64) -> Self {
        Self::in_memory_of(None, ground.into(), goal, lethal, weight)
    }

    /// Does the same from an `earlier` wave: where that came from the same goal, over an earlier state of the same `map`,
    /// only what changed since is spread anew, else its memory is used where it has the right size.
    pub fn instead_of(
        earlier: RestingWave,
        map: &InflatedMap,
        ground: Ground,
        goal: Cell,
        lethal: u8,
        weight: f64,
    ) -> Self {
        let RestingWave(mut wave) = earlier;
        if (wave.goal, wave.lethal) == (goal, lethal)
            && wave.weight == weight
            && let Some(changes) = map.changes_since(wave.moment)
        {
            // The frame is the same: another one would have been inflated anew.
            wave.costs = Arc::clone(&ground.costs);
            wave.moment = ground.moment;
            if wave.follow(changes) {
                return wave;
            }
        }
        Self::in_memory_of(Some(wave), ground, goal, lethal, weight)
    }

    /// Lets go of the costs.
    pub fn rest(self) -> RestingWave {
        let nothing = GridFrame { width: 0, height: 0, ..*self.costs.frame() };
        RestingWave(Self { costs: Arc::new(CostGrid::unknown(nothing)), ..self })
    }

    /// Returns the frame of its cells.
    pub fn frame(&self) -> &GridFrame {
        self.costs.frame()
    }

    fn in_memory_of(
        earlier: Option<Self>,
        ground: Ground,
        goal: Cell,
        lethal: u8,
        weight: f64,
    ) -> Self {
        let Ground { costs, moment } = ground;
        let frame = *costs.frame();
        let mut wave = match earlier {
            Some(earlier) => earlier.emptied(weight),
            None => Self::without_memory(&frame, weight),
        };
        if wave.distances.len() != padded_len(&frame) {
            wave.distances = vec![UNREACHED; padded_len(&frame)];
        }
        wave.units_per_metre = f64::from(STRAIGHT) * FINE / frame.resolution;
        (wave.costs, wave.moment, wave.goal, wave.lethal) = (costs, moment, goal, lethal);
        if wave.costs.is_below(goal, lethal) {
            wave.seed(goal);
        } else {
            for y in goal.y - BOX..=goal.y + BOX {
                for x in goal.x - BOX..=goal.x + BOX {
                    wave.seed(Cell::new(x, y));
                }
            }
        }
        wave
    }

    /// Creates a wave that has not come anywhere.
    fn without_memory(frame: &GridFrame, weight: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small and positive"
        )]
        let step = |plain: u32, cost: u8| {
            (f64::from(plain) * FINE * (1.0 + weight * f64::from(cost) / 100.0)).round() as u32
        };
        let diagonal: Vec<u32> = (0..=100).map(|cost| step(DIAGONAL, cost)).collect();
        let nothing = GridFrame { width: 0, height: 0, ..*frame };
        Self {
            costs: Arc::new(CostGrid::unknown(nothing)),
            moment: None,
            goal: Cell::new(0, 0),
            lethal: 0,
            weight,
            distances: Vec::new(),
            straight: (0..=100).map(|cost| step(STRAIGHT, cost)).collect(),
            buckets: vec![Vec::new(); (diagonal[100] as usize + 1).next_power_of_two()],
            diagonal,
            reached: Vec::new(),
            waiting: 0,
            level: 0,
            units_per_metre: 0.0,
        }
    }

    /// Forgets where it came, and keeps the memory as far as it is of use with `weight`.
    fn emptied(mut self, weight: f64) -> Self {
        for index in self.reached.drain(..) {
            self.distances[index as usize] = UNREACHED;
        }
        if self.weight != weight {
            let Self { distances, reached, .. } = self;
            return Self { distances, reached, ..Self::without_memory(self.costs.frame(), weight) };
        }
        if self.waiting > 0 {
            self.buckets.iter_mut().for_each(Vec::clear);
        }
        (self.waiting, self.level) = (0, 0);
        self
    }

    fn seed(&mut self, cell: Cell) {
        if let Some(index) = self.crossable(cell) {
            self.reach(index, 0);
        }
    }

    /// Returns the padded index of `cell` where it can be crossed.
    fn crossable(&self, cell: Cell) -> Option<usize> {
        let index = padded_index(self.costs.frame(), cell)?;
        (self.costs.padded()[index] < self.lethal).then_some(index)
    }

    fn reach(&mut self, index: usize, distance: u32) {
        let number = u32::try_from(index).unwrap_or(u32::MAX);
        if std::mem::replace(&mut self.distances[index], distance) == UNREACHED {
            self.reached.push(number);
        }
        let slot = self.slot(distance);
        self.buckets[slot].push(number);
        self.waiting += 1;
    }

    /// Returns the bucket of `distance`.
    fn slot(&self, distance: u32) -> usize {
        distance as usize & (self.buckets.len() - 1)
    }

    /// Spreads the wave for as long as it `goes_on`, and there is anything left to reach.
    fn spread_while(&mut self, goes_on: impl Fn(&Self) -> bool) {
        if self.waiting > 0 && goes_on(self) {
            let costs = Arc::clone(&self.costs);
            while self.waiting > 0 && goes_on(self) {
                self.spread(costs.padded());
            }
        }
    }

    /// Spreads the wave by one unit of distance.
    fn spread(&mut self, costs: &[u8]) {
        let slot = self.slot(self.level);
        if self.buckets[slot].is_empty() {
            self.level += 1;
            return;
        }
        let width = padded_width(self.costs.frame());
        let mut current = std::mem::take(&mut self.buckets[slot]);
        self.waiting -= current.len();
        let mut kept = 0;
        for i in 0..current.len() {
            let index = current[i] as usize;
            let distance = self.distances[index];
            if distance != self.level {
                // Reached more cheaply since, or, where the wave follows changes, not due before the next round.
                if distance > self.level && distance != UNREACHED && self.slot(distance) == slot {
                    current[kept] = current[i];
                    kept += 1;
                }
                continue;
            }
            let [straight, diagonal] = neighbours(index, width);
            for next in straight {
                self.step(next, costs[next], false);
            }
            for next in diagonal {
                self.step(next, costs[next], true);
            }
        }
        // Every step has a positive length, so nothing was added to the bucket; its memory is used again.
        current.truncate(kept);
        self.waiting += kept;
        self.buckets[slot] = current;
        self.level += 1;
    }

    fn step(&mut self, next: usize, cost: u8, is_diagonal: bool) {
        // Unknown cells, and those around the grid, cost more than anything lethal.
        if cost < self.lethal {
            let through = self.level + self.steps(is_diagonal)[usize::from(cost)];
            if through < self.distances[next] {
                self.reach(next, through);
            }
        }
    }

    /// Makes this the wave over its costs as they are now by looking at what `changed` in them, padded indices and perhaps more
    /// than did change (Ramalingam and Reps 1996), and returns whether it could: not where the seeds may be others, or so much
    /// changes that starting again is cheaper.
    ///
    /// 1. Whatever was reached by a step that now costs more, and by no other step as cheaply, is forgotten: nearest to the
    ///    goal first, so that all it may hang on is decided before it. It may hang on a cell that has come nearer since and
    ///    has not yet passed that on, so that its distance may be more than that cell's and the step.
    /// 2. What was forgotten or has another cost is reached anew from what is left.
    /// 3. The wave goes on at the nearest of these.
    fn follow(&mut self, changed: &[u32]) -> bool {
        let width = padded_width(self.costs.frame());
        let changed: Vec<usize> = changed.iter().map(|&index| index as usize).collect();
        let is_near_goal = |index: &usize| {
            let (x, y) = (index % width, index / width);
            let off = |at: usize, goal: i32| i32::try_from(at).unwrap_or(i32::MAX) - 1 - goal;
            off(x, self.goal.x).abs() <= BOX && off(y, self.goal.y).abs() <= BOX
        };
        let most = self.reached.len() / 4;
        if changed.len() > most || changed.iter().any(is_near_goal) {
            return false;
        }
        let costs = Arc::clone(&self.costs);
        let costs = costs.padded();
        // 1. What no longer holds.
        let mut doubtful: BinaryHeap<Reverse<(u32, usize)>> = BinaryHeap::new();
        let reached = changed.iter().filter(|index| self.distances[**index] != UNREACHED);
        doubtful.extend(reached.map(|&index| Reverse((self.distances[index], index))));
        let mut renewed = changed;
        while let Some(Reverse((distance, index))) = doubtful.pop() {
            if self.distances[index] != distance || self.offer(index, costs, width) <= distance {
                continue;
            }
            self.distances[index] = UNREACHED;
            renewed.push(index);
            if renewed.len() > most {
                return false;
            }
            for (beside, is_diagonal) in neighbours(index, width).into_iter().zip([false, true]) {
                for next in beside {
                    let beyond = self.distances[next];
                    if beyond != UNREACHED
                        && costs[next] < self.lethal
                        && beyond >= distance + self.steps(is_diagonal)[usize::from(costs[next])]
                    {
                        doubtful.push(Reverse((beyond, next)));
                    }
                }
            }
        }
        // 2. From what is left.
        let mut first = self.level;
        for index in renewed {
            let distance = self.offer(index, costs, width);
            if distance < self.distances[index] {
                self.reach(index, distance);
                first = first.min(distance);
            }
        }
        // 3. On from there.
        self.level = first;
        true
    }

    /// Returns the least distance that a neighbour of the cell gives it, [`UNREACHED`] where none does.
    fn offer(&self, index: usize, costs: &[u8], width: usize) -> u32 {
        let cost = costs[index];
        if cost >= self.lethal {
            return UNREACHED;
        }
        let nearest = |beside: [usize; 4]| {
            beside.iter().fold(UNREACHED, |least, &next| least.min(self.distances[next]))
        };
        let [straight, diagonal] = neighbours(index, width);
        let through = |nearest: u32, is_diagonal| {
            nearest.saturating_add(self.steps(is_diagonal)[usize::from(cost)])
        };
        through(nearest(straight), false).min(through(nearest(diagonal), true))
    }

    /// Returns the cost of a step into a cell of each cost.
    fn steps(&self, is_diagonal: bool) -> &[u32] {
        if is_diagonal { &self.diagonal } else { &self.straight }
    }

    /// Returns the distance of `cell` in wave units; [`UNREACHED`] where the wave does not come.
    pub fn distance(&mut self, cell: Cell) -> u32 {
        let Some(index) = self.crossable(cell) else { return UNREACHED };
        self.spread_while(|wave| wave.distances[index] >= wave.level);
        self.distances[index]
    }

    /// Returns the weighted distance of `cell` from the goal (m), or `None` where the wave does not come.
    pub fn metres(&mut self, cell: Cell) -> Option<f64> {
        match self.distance(cell) {
            UNREACHED => None,
            units => Some(f64::from(units) / self.units_per_metre),
        }
    }

    /// Returns whether the wave comes to `cell`.
    pub fn reaches(&mut self, cell: Cell) -> bool {
        let Some(index) = self.crossable(cell) else { return false };
        self.spread_while(|wave| wave.distances[index] == UNREACHED);
        self.distances[index] != UNREACHED
    }

    /// Returns the nearest neighbour downhill of `cell`, or `None` at the goal and where the wave does not come.
    pub fn downhill(&mut self, cell: Cell) -> Option<Cell> {
        let here = self.distance(cell);
        // Whatever is nearer than a final distance is final too.
        cell.neighbours8()
            .into_iter()
            .filter_map(|n| Some((self.distances[padded_index(self.costs.frame(), n)?], n)))
            .filter(|&(distance, _)| distance < here)
            .min_by_key(|&(distance, _)| distance)
            .map(|(_, neighbour)| neighbour)
    }

    /// Returns the path from `start` down to the goal, both included; empty where the wave does not come.
    pub fn path(&mut self, start: Cell) -> Vec<Cell> {
        if !self.reaches(start) {
            return Vec::new();
        }
        std::iter::successors(Some(start), |&cell| self.downhill(cell)).collect()
    }
}

/// Returns the padded indices of the straight and of the diagonal neighbours of a cell that is none of the padding.
fn neighbours(index: usize, width: usize) -> [[usize; 4]; 2] {
    [
        [index + 1, index + width, index - 1, index - width],
        [index + width + 1, index + width - 1, index - width - 1, index - width + 1],
    ]
}

/// Sub-units per tenth of a step: keeps rounding of weighted steps below half a percent.
const FINE: f64 = 2.0;

#[cfg(test)]
mod tests;

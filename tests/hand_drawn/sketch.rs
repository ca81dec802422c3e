//! What sets a drawn floor plan apart from the building it shows: rooms and doors counted, rooms that can be told again,
//! and how far its walls lie from the building's.

use reenact::geometry::Point;
use reenact::grid::{Cell, Grid, GridFrame, Occupancy, OccupancyGrid};
use std::collections::BTreeMap;

/// Widest gap in a wall that is a door (cells of 0.1 m).
const WIDEST_DOOR: i32 = 17;
/// ... and narrowest (cells); less is a flaw of the drawn line.
const NARROWEST_DOOR: i32 = 5;
/// A wall that ends at a door has nothing beside its end at this distance (cells), which is more than walls are thick.
const BESIDE: i32 = 4;
/// Thickest a door is (cells): more is a narrow room.
const THICKEST_DOOR: i32 = 5;
/// Smallest room (cells): 1 m2.
const SMALLEST_ROOM: usize = 100;
/// Fewer wall cells that hang together are a speck of the scanned paper.
const SPECK: usize = 10;

/// A plan taken apart.
pub(crate) struct Sketch {
    frame: GridFrame,
    /// Wall cells' centres (m).
    walls: Vec<Point>,
    /// The room of each cell of floor.
    rooms: Grid<Option<usize>>,
    /// The rooms' sizes (cells).
    sizes: Vec<usize>,
    doors: usize,
}

/// How a drawn plan differs from the true one; ratios are drawn over true.
#[derive(Debug)]
pub(crate) struct Errors {
    pub(crate) rooms: usize,
    pub(crate) doors: usize,
    pub(crate) width_ratio: f64,
    pub(crate) height_ratio: f64,
    /// Rooms that are each other's largest overlap, in the drawn and in the true plan.
    pub(crate) matched: usize,
    /// True rooms of which most lies in a drawn room that is another one's match.
    pub(crate) merged: usize,
    /// True rooms of which most lies where nothing is drawn.
    pub(crate) missing: usize,
    /// 10th percentile, median and 90th percentile of the matched rooms' areas, drawn over true.
    pub(crate) area_ratio: [f64; 3],
    /// Median and 90th percentile of the distance of drawn wall cells to the nearest true one (m).
    pub(crate) displacement_m: [f64; 2],
    /// Share of drawn wall cells with a true one within 0.5 m and 1 m.
    pub(crate) precision: [f64; 2],
    /// Share of true wall cells with a drawn one within 0.5 m and 1 m.
    pub(crate) recall: [f64; 2],
    /// Floor of both over floor of either.
    pub(crate) overlap: f64,
    /// Share of the true floor that lies, drawn, in its own room's match.
    pub(crate) same_room: f64,
}

impl Sketch {
    /// Creates the sketch of a plan on cells of 0.1 m; what is not free is wall.
    pub(crate) fn of(plan: &OccupancyGrid) -> Self {
        let frame = *plan.frame();
        let is_wall = |cell: Cell| plan.get(cell).is_some_and(|o| o != Occupancy::Free);
        let (mut closed, mut doors) = (Grid::filled(frame, false), 0);
        for along in [Cell::new(1, 0), Cell::new(0, 1)] {
            for piece in pieces(frame, &gaps(frame, along, is_wall)) {
                let across = |cell: &Cell| cell.x * along.y + cell.y * along.x;
                if extent(&piece, across) > THICKEST_DOOR {
                    continue;
                }
                for cell in &piece {
                    closed.set(*cell, true);
                }
                let width = extent(&piece, |cell| cell.x * along.x + cell.y * along.y);
                doors += usize::from(width >= NARROWEST_DOOR);
            }
        }
        let mut floor = Grid::filled(frame, false);
        for cell in frame.cells() {
            floor.set(cell, !is_wall(cell) && closed.get(cell) == Some(false));
        }
        let mut rooms = Grid::filled(frame, None);
        let mut sizes = Vec::new();
        for piece in pieces(frame, &floor) {
            if piece.len() < SMALLEST_ROOM || !piece.iter().all(|cell| frame.is_inside(*cell)) {
                continue;
            }
            for cell in &piece {
                rooms.set(*cell, Some(sizes.len()));
            }
            sizes.push(piece.len());
        }
        let mut solid = Grid::filled(frame, false);
        frame.cells().for_each(|cell| solid.set(cell, is_wall(cell)));
        let walls = pieces(frame, &solid).into_iter().filter(|piece| piece.len() >= SPECK);
        let walls = walls.flatten().map(|cell| frame.center(cell)).collect();
        Self { frame, walls, rooms, sizes, doors }
    }

    fn room_at(&self, at: Point) -> Option<usize> {
        self.rooms.get(self.frame.cell_at(at)).flatten()
    }

    fn extent(&self) -> [f64; 2] {
        let span = |values: Vec<f64>| {
            let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
            let (low, high) = values.iter().fold((low, high), |(l, h), v| (l.min(*v), h.max(*v)));
            high - low
        };
        let (x, y) = (|p: &Point| p.x, |p: &Point| p.y);
        [span(self.walls.iter().map(x).collect()), span(self.walls.iter().map(y).collect())]
    }

    /// Returns how this plan differs from `truth`.
    pub(crate) fn errors(&self, truth: &Self) -> Errors {
        // By the true plan's cells: which rooms lie over which.
        let mut over: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut drawn_of = vec![0; truth.sizes.len()];
        let (mut both, mut shared) = (0, Vec::new());
        for cell in truth.frame.cells() {
            let Some(room) = truth.rooms.get(cell).flatten() else { continue };
            if let Some(drawn) = self.room_at(truth.frame.center(cell)) {
                *over.entry((room, drawn)).or_default() += 1;
                drawn_of[room] += 1;
                both += 1;
                shared.push((room, drawn));
            }
        }
        let best = |of: &dyn Fn(&(usize, usize)) -> bool| {
            over.iter().filter(|(pair, _)| of(pair)).max_by_key(|(_, n)| **n).map(|(pair, _)| *pair)
        };
        let matches: BTreeMap<usize, usize> = (0..truth.sizes.len())
            .filter_map(|room| best(&|pair| pair.0 == room))
            .filter(|pair| best(&|other| other.1 == pair.1) == Some(*pair))
            .collect();
        let lost = (0..truth.sizes.len()).filter(|room| !matches.contains_key(room));
        let (missing, merged): (Vec<usize>, Vec<usize>) =
            lost.partition(|room| 2 * drawn_of[*room] < truth.sizes[*room]);
        let mut ratios: Vec<f64> =
            matches.iter().map(|(t, d)| ratio(self.sizes[*d], truth.sizes[*t])).collect();
        let (there, back) =
            (distances(&self.walls, &truth.walls), distances(&truth.walls, &self.walls));
        let within = |distances: &[f64], reach: f64| {
            ratio(distances.iter().filter(|d| **d <= reach + 1e-9).count(), distances.len())
        };
        let total = |sizes: &[usize]| sizes.iter().sum::<usize>();
        let mut sorted = there.clone();
        let ([width, height], [true_width, true_height]) = (self.extent(), truth.extent());
        Errors {
            rooms: self.sizes.len(),
            doors: self.doors,
            width_ratio: width / true_width,
            height_ratio: height / true_height,
            matched: matches.len(),
            merged: merged.len(),
            missing: missing.len(),
            area_ratio: [0.1, 0.5, 0.9].map(|share| quantile(&mut ratios, share)),
            displacement_m: [0.5, 0.9].map(|share| quantile(&mut sorted, share)),
            precision: [0.5, 1.0].map(|reach| within(&there, reach)),
            recall: [0.5, 1.0].map(|reach| within(&back, reach)),
            overlap: ratio(both, total(&self.sizes) + total(&truth.sizes) - both),
            same_room: ratio(
                shared.iter().filter(|(t, d)| matches.get(t) == Some(d)).count(),
                total(&truth.sizes),
            ),
        }
    }
}

/// Returns the free cells of runs `along` an axis that are short enough for a door and at one end of which a wall ends.
/// (Where both are walls that go on to the sides, it is the mouth of a corridor or a narrow room.)
fn gaps(frame: GridFrame, along: Cell, is_wall: impl Fn(Cell) -> bool) -> Grid<bool> {
    let mut gaps = Grid::filled(frame, false);
    let (lines, length) =
        if along.x == 1 { (frame.height, frame.width) } else { (frame.width, frame.height) };
    for line in 0..lines {
        let at = |i: i32| Cell::new(along.x * i + along.y * line, along.y * i + along.x * line);
        // Runs of equal cells, as (wall, first, length).
        let mut runs: Vec<(bool, i32, i32)> = Vec::new();
        for i in 0..length {
            match runs.last_mut() {
                Some(run) if run.0 == is_wall(at(i)) => run.2 += 1,
                _ => runs.push((is_wall(at(i)), i, 1)),
            }
        }
        for around in runs.windows(3) {
            let [_, (wall, first, cells), (_, after, _)] = *around else { continue };
            let ends = |i: i32| {
                [-BESIDE, BESIDE].iter().all(|d| {
                    let Cell { x, y } = at(i);
                    !is_wall(Cell::new(x + d * along.y, y + d * along.x))
                })
            };
            if !wall && cells <= WIDEST_DOOR && (ends(first - 1) || ends(after)) {
                (first..after).for_each(|i| gaps.set(at(i), true));
            }
        }
    }
    gaps
}

/// Returns the pieces of what is set, joined by sides.
fn pieces(frame: GridFrame, set: &Grid<bool>) -> Vec<Vec<Cell>> {
    let mut seen = Grid::filled(frame, false);
    let mut all = Vec::new();
    for first in frame.cells() {
        if set.get(first) != Some(true) || seen.get(first) == Some(true) {
            continue;
        }
        seen.set(first, true);
        let (mut piece, mut done) = (vec![first], 0);
        while done < piece.len() {
            for next in piece[done].neighbours4() {
                if seen.get(next) == Some(false) && set.get(next) == Some(true) {
                    seen.set(next, true);
                    piece.push(next);
                }
            }
            done += 1;
        }
        all.push(piece);
    }
    all
}

/// Returns how many cells a piece reaches over, by the coordinate `of`.
fn extent(piece: &[Cell], of: impl Fn(&Cell) -> i32) -> i32 {
    let (low, high) = (piece.iter().map(&of).min(), piece.iter().map(&of).max());
    high.zip(low).map_or(0, |(high, low)| high - low + 1)
}

/// Returns for each of `from` the distance to the nearest of `to` (m).
fn distances(from: &[Point], to: &[Point]) -> Vec<f64> {
    let nearest =
        |at: &Point| to.iter().map(|other| other.distance(*at)).fold(f64::INFINITY, f64::min);
    from.iter().map(nearest).collect()
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = f64::from(u32::try_from(values.len() - 1).unwrap());
    let at = (share * last).round();
    let index = (0..values.len()).find(|i| f64::from(u32::try_from(*i).unwrap()) >= at).unwrap();
    values[index]
}

fn ratio(part: usize, whole: usize) -> f64 {
    f64::from(u32::try_from(part).unwrap()) / f64::from(u32::try_from(whole).unwrap())
}

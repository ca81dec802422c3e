//! The beams of a scan as the search for its pose uses them: several at once.

use super::tile::{Place, QUARTER_BITS, units};
use crate::geometry::{Point, Pose};
use crate::math;

/// Beams that are looked at in one go; between two such, whether a pose can still win is tested.
pub(super) const LANES: usize = 16;
/// Beams between two neighbours of a scan that are looked at one after the other.
const SPREAD: usize = 16;

/// Points (m), coordinate by coordinate.
#[derive(Debug, Default)]
pub(super) struct Points {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Points {
    /// Replaces the points.
    pub(super) fn take(&mut self, points: impl Iterator<Item = Point>) {
        self.x.clear();
        self.y.clear();
        for point in points {
            self.x.push(point.x);
            self.y.push(point.y);
        }
    }

    /// Computes where the points are with the robot at `pose`, in units of which a metre has `scale`: into `places`.
    pub(super) fn seen_from(&self, pose: Pose, scale: f64, places: &mut Vec<Place>) {
        let (sin, cos) = math::sin_cos(pose.heading);
        places.clear();
        places.extend(self.x.iter().zip(&self.y).map(|(x, y)| Place {
            x: units(pose.x + cos * x - sin * y, scale),
            y: units(pose.y + sin * x + cos * y, scale),
        }));
    }
}

/// A coordinate (units) as the quarter of a cell that holds it and what is left, both in 16 bits. The quarter's number wraps
/// around.
#[derive(Debug, Clone, Copy)]
pub(super) struct Split {
    pub(super) quarter: i16,
    pub(super) within: i16,
}

impl Split {
    #[expect(clippy::cast_possible_truncation, reason = "wraps around")]
    pub(super) fn of(v: i32) -> Self {
        Self { quarter: (v >> QUARTER_BITS) as i16, within: (v & ((1 << QUARTER_BITS) - 1)) as i16 }
    }
}

/// The ends of beams that are looked at in one go, split.
#[derive(Debug, Clone, Copy)]
pub(super) struct Go<'a> {
    pub(super) x_quarter: &'a [i16; LANES],
    pub(super) x_within: &'a [i16; LANES],
    pub(super) y_quarter: &'a [i16; LANES],
    pub(super) y_within: &'a [i16; LANES],
    whole: &'a [Place],
}

impl Go<'_> {
    /// Returns the end of this number, in units.
    pub(super) fn place(&self, i: usize) -> Place {
        self.whole.get(i).copied().unwrap_or_default()
    }
}

/// The ends of beams in the robot's frame, in an order that suits the search.
#[derive(Debug, Default)]
pub(super) struct Beams {
    ends: Points,
    /// How many there are; those that follow fill up the last go.
    count: usize,
    /// Ends turned to the heading of the search.
    pub(super) here: Turned,
    /// ... and to the headings beside it: to the left and to the right.
    pub(super) aside: [Turned; 2],
}

/// The ends turned to some heading, in units.
#[derive(Debug, Default)]
pub(super) struct Turned {
    /// The heading's bits.
    heading: Option<u64>,
    whole: Vec<Place>,
    x_quarter: Vec<i16>,
    x_within: Vec<i16>,
    y_quarter: Vec<i16>,
    y_within: Vec<i16>,
    count: usize,
    bounds: [Place; 2],
}

impl Beams {
    /// Replaces the beams by those with these `ends`, in the robot's frame (m).
    pub(super) fn take(&mut self, ends: impl Iterator<Item = Point>) {
        let ends: Vec<Point> = ends.collect();
        // Distant neighbours first, so that few beams show whether a pose can win. The sum is of whole numbers: no
        // order changes it.
        let spread = (0..SPREAD).flat_map(|first| ends.iter().skip(first).step_by(SPREAD));
        let missing = ends.len().next_multiple_of(LANES) - ends.len();
        let filling = ends.first().into_iter().cycle().take(missing);
        self.ends.take(spread.chain(filling).copied());
        self.count = ends.len();
        for turned in [&mut self.here].into_iter().chain(&mut self.aside) {
            turned.heading = None;
        }
    }

    /// Turns the ends to `heading`, in units of which a metre has `scale`: into `here`.
    pub(super) fn turn(&mut self, heading: f64, scale: f64) {
        self.here.turn(&self.ends, self.count, heading, scale);
    }

    /// Turns the ends to `heading`: into those `aside` of this number.
    pub(super) fn turn_aside(&mut self, side: usize, heading: f64, scale: f64) {
        self.aside[side].turn(&self.ends, self.count, heading, scale);
    }

    /// Makes the heading of this number the one of the search.
    pub(super) fn adopt(&mut self, side: usize) {
        std::mem::swap(&mut self.here, &mut self.aside[side]);
    }
}

impl Turned {
    fn turn(&mut self, ends: &Points, count: usize, heading: f64, scale: f64) {
        if self.heading.replace(heading.to_bits()) == Some(heading.to_bits()) {
            return;
        }
        let (sin, cos) = math::sin_cos(heading);
        self.count = count;
        self.whole.clear();
        self.whole.extend(ends.x.iter().zip(&ends.y).map(|(x, y)| Place {
            x: units(cos * x - sin * y, scale),
            y: units(sin * x + cos * y, scale),
        }));
        let (mut low, mut high) =
            (Place { x: i32::MAX, y: i32::MAX }, Place { x: i32::MIN, y: i32::MIN });
        for end in &self.whole {
            low = Place { x: low.x.min(end.x), y: low.y.min(end.y) };
            high = Place { x: high.x.max(end.x), y: high.y.max(end.y) };
        }
        self.bounds = [low, high];
        let fill = |into: &mut Vec<i16>, part: fn(&Place) -> i16| {
            into.clear();
            into.extend(self.whole.iter().map(part));
        };
        fill(&mut self.x_quarter, |end| Split::of(end.x).quarter);
        fill(&mut self.x_within, |end| Split::of(end.x).within);
        fill(&mut self.y_quarter, |end| Split::of(end.y).quarter);
        fill(&mut self.y_within, |end| Split::of(end.y).within);
    }

    /// Returns how many ends there are.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns the lowest and the highest coordinates.
    pub(super) fn bounds(&self) -> [Place; 2] {
        self.bounds
    }

    /// Returns the ends of each go; the last may hold more than there are.
    pub(super) fn goes(&self) -> impl Iterator<Item = Go<'_>> {
        let x = self.x_quarter.as_chunks().0.iter().zip(self.x_within.as_chunks().0);
        let y = self.y_quarter.as_chunks().0.iter().zip(self.y_within.as_chunks().0);
        let whole = self.whole.chunks(LANES);
        x.zip(y).zip(whole).map(|(((x_quarter, x_within), (y_quarter, y_within)), whole)| Go {
            x_quarter,
            x_within,
            y_quarter,
            y_within,
            whole,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SCALE: f64 = 5120.0;

    fn points() -> impl Strategy<Value = Vec<Point>> {
        let point = (-30.0..30.0, -30.0..30.0).prop_map(|(x, y)| Point::new(x, y));
        prop::collection::vec(point, 0..50)
    }

    /// Returns the ends, each once, in some order of their own.
    fn told(turned: &Turned) -> Vec<[i32; 2]> {
        let mut told: Vec<_> = turned
            .goes()
            .flat_map(|go| (0..LANES).map(move |i| go.place(i)))
            .take(turned.count())
            .map(|end| [end.x, end.y])
            .collect();
        told.sort_unstable();
        told
    }

    proptest! {
        #[test]
        fn ends_are_where_the_pose_puts_them(
            points in points(), x in -90.0..90.0, y in -90.0..90.0, heading in -4.0..4.0,
        ) {
            let pose = Pose::new(x, y, heading);
            let (mut hits, mut places) = (Points::default(), Vec::new());
            hits.take(points.iter().copied());
            hits.seen_from(pose, SCALE, &mut places);
            let plainly = |point: &Point| Place::of(pose.transform(*point), SCALE);
            prop_assert_eq!(places, points.iter().map(plainly).collect::<Vec<_>>());
        }

        /// Checks turning, also back to a heading that is still held, and after the beams have been replaced.
        #[test]
        fn turned_ends_are_those_of_the_heading(
            scans in prop::collection::vec(points(), 1..3),
            headings in prop::collection::vec(-4.0..4.0, 1..4),
        ) {
            let mut beams = Beams::default();
            for points in &scans {
                beams.take(points.iter().copied());
                for &heading in headings.iter().chain(&headings).chain(&headings[..1]) {
                    let (sin, cos) = math::sin_cos(heading);
                    let mut plainly: Vec<_> = points
                        .iter()
                        .map(|p| Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y))
                        .map(|point| Place::of(point, SCALE))
                        .map(|end| [end.x, end.y])
                        .collect();
                    plainly.sort_unstable();
                    beams.turn_aside(1, heading, SCALE);
                    prop_assert_eq!(&told(&beams.aside[1]), &plainly);
                    beams.adopt(1);
                    prop_assert_eq!(&told(&beams.here), &plainly);
                    let [low, high] = beams.here.bounds();
                    for [x, y] in plainly {
                        prop_assert!((low.x..=high.x).contains(&x) && (low.y..=high.y).contains(&y));
                    }
                }
            }
        }

        #[test]
        fn split_coordinates_add_up(v in any::<i32>()) {
            let split = Split::of(v);
            prop_assert!((0..1 << QUARTER_BITS).contains(&split.within));
            let low = i32::from(split.quarter) << QUARTER_BITS | i32::from(split.within);
            prop_assert_eq!((low ^ v) & ((1 << (16 + QUARTER_BITS)) - 1), 0);
        }
    }
}

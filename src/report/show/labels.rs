//! Names of regions, each where it can be read: inside its region, off marks, furniture and other names; upright if it must be, and
//! where there is no room at all as a number that a key below the drawing explains.

use crate::figure::canvas::Canvas;
use crate::figure::svg::{Element, number};
use crate::geometry::{Bounds, Outline, Point};
use crate::world::Region;

/// How a name may be written, best first: size (px), and whether it is turned.
const WAYS: [(f64, bool); 4] = [(12.0, false), (12.0, true), (10.0, false), (10.0, true)];

/// Around a name (px).
const MARGIN: f64 = 3.0;

/// What a name should keep off.
pub(super) struct Taken<'a> {
    /// Marks, such as tags and starts: never.
    pub(super) marks: Vec<Bounds>,
    /// What stands there: where possible.
    pub(super) solids: &'a [Outline],
}

/// Writes the names of `regions`, and returns the key of those that became numbers.
pub(super) fn name_regions(
    canvas: &mut Canvas,
    regions: &[Region],
    taken: &mut Taken<'_>,
) -> Vec<String> {
    let mut key = Vec::new();
    for region in regions {
        let outline = Outline::Polygon(region.polygon.clone());
        let found = WAYS.iter().find_map(|&way| {
            let (at, bounds) = place(canvas, &outline, &region.name, way, taken, true)?;
            Some((way, at, bounds))
        });
        // Over furniture rather than small or not at all.
        let found = found.or_else(|| {
            WAYS.iter().find_map(|&way| {
                let (at, bounds) = place(canvas, &outline, &region.name, way, taken, false)?;
                Some((way, at, bounds))
            })
        });
        if let Some((way, at, bounds)) = found {
            write(canvas, at, way, &region.name);
            taken.marks.push(bounds);
            continue;
        }
        key.push(format!("{} {}", key.len() + 1, region.name));
        let text = key.len().to_string();
        let way = WAYS[2];
        let spot = [true, false].into_iter().find_map(|strict| {
            place(canvas, &outline, &text, way, taken, strict).map(|(at, _)| at)
        });
        let at = spot.unwrap_or_else(|| middle(&region.polygon));
        taken.marks.push(extent(canvas, at, &text, way));
        let italic = label(canvas, at, way, &text).set("font-style", "italic");
        canvas.push(italic);
    }
    key
}

fn write(canvas: &mut Canvas, at: Point, way: (f64, bool), text: &str) {
    let label = label(canvas, at, way, text);
    canvas.push(label);
}

fn label(canvas: &Canvas, at: Point, (size, turned): (f64, bool), text: &str) -> Element {
    let (x, y) = canvas.at(at);
    if !turned {
        return canvas.label(at, (0.0, 0.35 * size), size, text);
    }
    let turn = format!("rotate(-90 {} {})", number(x), number(y));
    canvas.label(at, (0.0, 0.35 * size), size, text).set("transform", turn)
}

/// Returns the room (m) that a text around `at` takes.
fn extent(canvas: &Canvas, at: Point, text: &str, (size, turned): (f64, bool)) -> Bounds {
    #[expect(clippy::cast_precision_loss, reason = "names are short")]
    let long = 0.56 * size * text.chars().count() as f64 + 2.0 * MARGIN;
    let (long, high) = (long / canvas.scale(), (size + 2.0 * MARGIN) / canvas.scale());
    let half = if turned { Point::new(high, long) } else { Point::new(long, high) } * 0.5;
    Bounds { min: at - half, max: at + half }
}

/// Finds the place for `text` inside `region` that is nearest to its middle; `strict` keeps off what stands there too.
fn place(
    canvas: &Canvas,
    region: &Outline,
    text: &str,
    way: (f64, bool),
    taken: &Taken<'_>,
    strict: bool,
) -> Option<(Point, Bounds)> {
    let Outline::Polygon(corners) = region else { return None };
    let (around, center) = (region.bounds(), middle(corners));
    // A raster of about 6 px.
    let steps = |length: f64| {
        #[expect(clippy::cast_possible_truncation, reason = "at most a hundred")]
        let count = (length * canvas.scale() / 6.0).ceil().clamp(1.0, 100.0) as i32;
        (0..=count).map(move |i| length * f64::from(i) / f64::from(count))
    };
    let fits = |at: &Point| {
        let room = extent(canvas, *at, text, way);
        let corners = [
            room.min,
            room.max,
            Point::new(room.min.x, room.max.y),
            Point::new(room.max.x, room.min.y),
            (room.min + room.max) * 0.5,
            Point::new(f64::midpoint(room.min.x, room.max.x), room.min.y),
            Point::new(f64::midpoint(room.min.x, room.max.x), room.max.y),
        ];
        corners.iter().all(|corner| region.contains(*corner))
            && taken.marks.iter().all(|mark| !overlap(room, *mark))
            && (!strict || taken.solids.iter().all(|solid| !overlap(room, solid.bounds())))
    };
    let mut candidates: Vec<Point> = steps(around.width())
        .flat_map(|x| steps(around.height()).map(move |y| (x, y)))
        .map(|(x, y)| around.min + Point::new(x, y))
        .chain([center])
        .collect();
    // Stable: of two equally near ones the first.
    candidates.sort_by(|a, b| a.distance(center).total_cmp(&b.distance(center)));
    let at = candidates.into_iter().find(|at| fits(at))?;
    Some((at, extent(canvas, at, text, way)))
}

fn overlap(a: Bounds, b: Bounds) -> bool {
    a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y
}

/// Computes the centroid of a simple polygon; the mean of its corners where it has no area.
fn middle(corners: &[Point]) -> Point {
    let (mut area, mut sum) = (0.0, Point::ZERO);
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let cross = a.cross(b);
        area += cross;
        sum = sum + (*a + b) * cross;
    }
    if area.abs() < 1e-9 {
        #[expect(clippy::cast_precision_loss, reason = "a polygon has few corners")]
        let count = corners.len().max(1) as f64;
        return corners.iter().fold(Point::ZERO, |sum, corner| sum + *corner) * (1.0 / count);
    }
    sum * (1.0 / (3.0 * area))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::RegionKind;

    fn room(name: &str, low: (f64, f64), high: (f64, f64)) -> Region {
        let corners = [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)];
        Region {
            name: name.into(),
            kind: RegionKind::Room,
            polygon: corners.map(|(x, y)| Point::new(x, y)).to_vec(),
        }
    }

    fn canvas() -> Canvas {
        // 100 px a metre.
        Canvas::new(Bounds { min: Point::ZERO, max: Point::new(10.0, 5.0) }, 1000.0, 500.0)
    }

    #[test]
    fn a_name_without_room_is_turned_or_becomes_a_number() {
        let rooms = [
            room("living-room", (0.0, 0.0), (3.0, 3.0)),
            room("narrow-and-tall", (3.0, 0.0), (3.3, 3.0)),
            room("much-too-small-for-this", (4.0, 0.0), (4.4, 0.4)),
        ];
        let mut canvas = canvas();
        let mut taken = Taken { marks: Vec::new(), solids: &[] };
        assert_eq!(name_regions(&mut canvas, &rooms, &mut taken), ["1 much-too-small-for-this"]);
        let svg = canvas.finish("x");
        assert_eq!(svg.matches("rotate(-90").count(), 1, "{svg}");
        assert!(svg.contains(">1</text>"), "{svg}");
    }

    #[test]
    fn a_name_keeps_off_what_stands_there_and_off_other_names() {
        let table = Outline::rectangle(Point::new(1.5, 1.5), 1.0, 1.0, 0.0);
        let rooms =
            [room("living-room", (0.0, 0.0), (3.0, 3.0)), room("alcove", (0.0, 0.0), (3.0, 3.0))];
        let mut taken = Taken { marks: Vec::new(), solids: std::slice::from_ref(&table) };
        name_regions(&mut canvas(), &rooms, &mut taken);
        let [first, second] = taken.marks[..] else { panic!("two names") };
        assert!(
            !overlap(first, second)
                && !overlap(first, table.bounds())
                && !overlap(second, table.bounds())
        );
    }
}

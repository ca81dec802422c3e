//! A building from above, with its dimensions; over it, where wanted, the obstacles of a grid map.

use super::canvas::{ACCENT, Canvas, metres};
use super::medium::Medium;
use super::svg::{Element, number};
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::grid::{Cell, Occupancy, OccupancyGrid};

/// Fill of the walls.
const WALL: &str = "#2b2b2b";
/// Fill of everything else.
const FURNITURE: &str = "#9a9a9a";
/// Fill of the obstacles of a grid map laid over the plan: orange, as in the prior-knowledge study's Figure 5.
const OVERLAY: &str = "#e69f00";
/// Stroke of crosses: red, as in the same study's Figure 7.
const CROSS: &str = "#d62728";

/// A building cut at some height, to be drawn. Lengths in m, in the world's frame.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    /// Title of the drawing.
    pub title: String,
    /// Whatever always stands, such as walls.
    pub walls: Vec<Outline>,
    /// Whatever else stands.
    pub furniture: Vec<Outline>,
    /// Whatever is shown by a cross over its place alone, such as closed doors.
    pub crossed: Vec<Outline>,
    /// What the crosses are, for the legend.
    pub crossed_name: String,
    /// The robot's first pose.
    pub start: Option<Pose>,
    /// A grid map over the plan, with its name.
    pub overlay: Option<(&'a str, &'a OccupancyGrid)>,
}

impl Plan<'_> {
    /// Draws the plan as an SVG file: furniture under walls, the map's obstacles, crosses, the start, outer dimensions,
    /// axes, heading and legend, in this order.
    pub fn to_svg(&self) -> String {
        self.to_svg_on(Medium::Screen)
    }

    /// Draws it as wide as `medium` wants it.
    pub fn to_svg_on(&self, medium: Medium) -> String {
        let shapes = self.walls.iter().chain(&self.furniture);
        let mut inner = shapes.fold(Bounds::EMPTY, |b, outline| b.union(outline.bounds()));
        if inner.is_empty() {
            inner = Bounds { min: Point::ZERO, max: Point::new(1.0, 1.0) };
        }
        let mut whole = inner;
        if let Some((_, map)) = self.overlay {
            for cell in map.frame().cells().filter(|cell| map.at(*cell) == Occupancy::Occupied) {
                whole = whole.including(map.frame().center(cell));
            }
        }
        let span = whole.width().max(whole.height());
        let whole = whole.grown(0.09 * span);
        let mut canvas = match medium.width() {
            None => Canvas::new(whole, 900.0, 640.0),
            Some(width) => Canvas::of_width(whole, width),
        };
        let fills = [(&self.walls, WALL), (&self.furniture, FURNITURE)];
        for (outlines, fill) in fills.into_iter().rev() {
            for outline in outlines {
                let shape = canvas.outline(outline).set("fill", fill);
                canvas.push(shape);
            }
        }
        if let Some((_, map)) = self.overlay {
            // Cells as runs along a row, in units of cells from the upper left corner.
            let corner = Point::new(map.frame().origin.x, map.frame().bounds().max.y);
            let (left, top) = canvas.at(corner);
            let side = map.frame().resolution * canvas.scale();
            let move_there = format!("translate({} {}) scale({side})", number(left), number(top));
            let data = cell_runs(map, |_, value| value == Occupancy::Occupied);
            canvas.push(
                Element::new("path")
                    .set("d", data)
                    .set("fill", OVERLAY)
                    .set("fill-opacity", "0.75")
                    // A wall of one cell must not vanish beside those of the building.
                    .set("stroke", OVERLAY)
                    .set("stroke-width", 1)
                    .set("transform", move_there),
            );
        }
        for outline in &self.crossed {
            let bounds = outline.bounds();
            let middle = (bounds.min + bounds.max) * 0.5;
            let arm = 0.5 * bounds.width().max(bounds.height()).max(0.012 * span);
            for turn in [1.0, -1.0] {
                let arm = Point::new(arm, turn * arm);
                let (from, to) = (canvas.at(middle - arm), canvas.at(middle + arm));
                let line = Element::new("line").at("x1", from.0).at("y1", from.1);
                let line = line.at("x2", to.0).at("y2", to.1);
                canvas.push(line.set("stroke", CROSS).set("stroke-width", 2.5));
            }
        }
        if let Some(start) = self.start {
            let tip = start.transform(Point::new(0.05 * span, 0.0));
            canvas.arrow(start.position(), tip, ACCENT);
            let (x, y) = canvas.at(start.position());
            let spot = Element::new("circle").at("cx", x).at("cy", y).at("r", 4.0);
            canvas.push(spot.set("fill", ACCENT));
            let label = canvas.label(start.position(), (0.0, 18.0), 12.0, "start");
            canvas.push(label);
        }
        let Bounds { min, max } = inner;
        let (width, height) = (max.x - min.x, max.y - min.y);
        let across = format!("{} m", metres((width * 100.0).round() / 100.0));
        let along = format!("{} m", metres((height * 100.0).round() / 100.0));
        canvas.dimension(Point::new(min.x, max.y), max, 22.0, &across);
        canvas.dimension(min, Point::new(min.x, max.y), 22.0, &along);
        canvas.axes();
        let size = format!("{across} by {along} over all");
        canvas.heading(&self.title, &size);
        let mut legend = vec![("walls".to_owned(), WALL, WALL)];
        if !self.furniture.is_empty() {
            legend.push(("furniture".to_owned(), FURNITURE, FURNITURE));
        }
        if !self.crossed.is_empty() {
            legend.push((self.crossed_name.clone(), CROSS, CROSS));
        }
        if let Some((name, _)) = self.overlay {
            legend.push((name.to_owned(), OVERLAY, OVERLAY));
        }
        canvas.legend(&legend);
        canvas.finish(&self.title)
    }
}

/// Writes the cells for which `wanted` holds as the data of one path: a rectangle for each run along a row, in units of
/// cells from the upper left corner of the map, y downwards.
pub fn cell_runs(map: &OccupancyGrid, wanted: impl Fn(Cell, Occupancy) -> bool) -> String {
    let (frame, mut data) = (map.frame(), String::new());
    for y in 0..frame.height {
        let row = frame.height - 1 - y;
        let is = |x: i32| wanted(Cell::new(x, y), map.at(Cell::new(x, y)));
        let mut x = 0;
        while x < frame.width {
            let begin = x;
            while x < frame.width && is(x) {
                x += 1;
            }
            if x > begin {
                let long = x - begin;
                data.push_str(&format!("M{begin} {row}h{long}v1h-{long}z"));
            }
            x += 1;
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GridFrame;

    fn map() -> OccupancyGrid {
        let frame =
            GridFrame { resolution: 0.5, origin: Point::new(-1.0, -1.0), width: 8, height: 6 };
        let mut map = OccupancyGrid::filled(frame, Occupancy::Free);
        for x in [0, 1, 2, 5, 7] {
            map.set(Cell::new(x, 5), Occupancy::Occupied);
        }
        map.set(Cell::new(7, 0), Occupancy::Occupied);
        map
    }

    #[test]
    fn runs_are_as_long_as_the_rows_say() {
        let data = cell_runs(&map(), |_, value| value == Occupancy::Occupied);
        assert_eq!(data, "M7 5h1v1h-1zM0 0h3v1h-3zM5 0h1v1h-1zM7 0h1v1h-1z");
        assert_eq!(cell_runs(&map(), |cell, _| cell.x < 0), "");
    }

    #[test]
    fn a_plan_tells_its_dimensions_and_what_lies_over_it() {
        let wall = |x: f64| {
            Outline::Polygon(vec![
                Point::new(x, 0.0),
                Point::new(x + 0.15, 0.0),
                Point::new(x + 0.15, 4.25),
                Point::new(x, 4.25),
            ])
        };
        let (walls, map) = (vec![wall(0.0), wall(9.85)], map());
        let mut plan = Plan {
            title: "Plan <a>".to_owned(),
            walls,
            furniture: Vec::new(),
            crossed: Vec::new(),
            crossed_name: "closed-doors".to_owned(),
            start: Some(Pose::new(1.0, 1.0, 0.0)),
            overlay: Some(("bounding-box", &map)),
        };
        let svg = plan.to_svg();
        roxmltree::Document::parse(&svg).unwrap();
        assert!(svg.contains("10 m by 4.25 m over all") && svg.contains(">bounding-box<"));
        assert!(svg.contains(OVERLAY) && !svg.contains(">furniture<"));
        plan.overlay = None;
        assert!(!plan.to_svg().contains(OVERLAY) && !plan.to_svg().contains(CROSS));
        plan.crossed = vec![Outline::Circle { center: Point::new(5.0, 2.0), radius: 0.5 }];
        let svg = plan.to_svg();
        assert_eq!(svg.matches(&format!("stroke=\"{CROSS}\" stroke-width=\"2.5\"")).count(), 2);
        assert!(svg.contains(">closed-doors<"));
        plan.crossed.clear();
        let empty = Plan { walls: Vec::new(), start: None, ..plan };
        assert!(!empty.to_svg().contains("NaN") && !empty.to_svg().contains("inf"));
    }
}

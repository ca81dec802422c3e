//! A world cut at the lidar's height: layers in grey, regions, starts, goals and tags.

use super::canvas::{ACCENT, Canvas, FAINT, INK};
use crate::figure::svg::Element;
use crate::geometry::{Bounds, Outline, Point};
use crate::world::{RegionKind, World};

/// Greys of the layers, in the order walls first, then by name.
const GREYS: [&str; 5] = ["#2b2b2b", "#8c8c8c", "#b8b8b8", "#6a6a6a", "#d2d2d2"];

/// The world at `lidar_height` m, as an SVG file. What the plane misses is drawn as a thin outline.
pub fn world_svg(world: &World, lidar_height: f64) -> String {
    let mut bounds = world.bounds();
    for point in
        world.starts.values().map(|pose| pose.position()).chain(world.goals.values().copied())
    {
        bounds = bounds.including(point);
    }
    if bounds.is_empty() {
        bounds = Bounds { min: Point::ZERO, max: Point::new(1.0, 1.0) };
    }
    let size = (bounds.width(), bounds.height());
    let span = size.0.max(size.1);
    let mut canvas = Canvas::new(bounds.grown(0.03 * span), 1000.0, 760.0);
    canvas.raster();
    for region in &world.regions {
        let fill = if region.kind == RegionKind::Room { "#f3efe6" } else { "#e6edf3" };
        let area = canvas.path(&region.polygon, true).set("fill", fill);
        canvas.push(area);
    }
    let mut layers = world.layers();
    layers.sort_by_key(|name| (*name != "walls", *name));
    let grey = |layer: &str| {
        GREYS[layers.iter().position(|name| *name == layer).unwrap_or(0) % GREYS.len()]
    };
    let mut missed = false;
    let mut cut = Vec::new();
    for solid in &world.solids {
        if let Some(outline) = solid.body.slice(lidar_height) {
            cut.push((grey(&solid.layer), outline));
        } else if let Some(outline) = solid.body.shadow(f64::NEG_INFINITY, f64::INFINITY) {
            missed = true;
            let shape = canvas
                .outline(&outline)
                .set("fill", "none")
                .set("stroke", "#a8a8a8")
                .set("stroke-dasharray", "3 2");
            canvas.push(shape);
        }
    }
    for (fill, outline) in cut {
        let shape = match &outline {
            // A table leg of 2 cm must not vanish.
            Outline::Circle { center, radius } => {
                let least = 1.2 / canvas.scale();
                canvas.outline(&Outline::Circle { center: *center, radius: radius.max(least) })
            }
            Outline::Polygon(_) => canvas.outline(&outline),
        };
        canvas.push(shape.set("fill", fill));
    }
    for region in &world.regions {
        let label = canvas.label(middle(&region.polygon), (0.0, 4.0), 12.0, &region.name);
        canvas.push(label);
    }
    for tag in &world.tags {
        let dot = Outline::Circle { center: tag.pose.position(), radius: 3.0 / canvas.scale() };
        let dot = canvas.outline(&dot).set("fill", "#fff").set("stroke", INK);
        canvas.push(
            dot.child(Element::new("title").text(&format!("tag {} ({})", tag.id, tag.color))),
        );
    }
    for (name, goal) in &world.goals {
        let arm = 6.0 / canvas.scale();
        for (dx, dy) in [(arm, arm), (arm, -arm)] {
            let by = Point::new(dx, dy);
            let stroke = canvas
                .path(&[*goal - by, *goal + by], false)
                .set("stroke", ACCENT)
                .set("stroke-width", 2.5);
            canvas.push(stroke);
        }
        let label = canvas.label(*goal, (0.0, -11.0), 12.0, &format!("goal {name}"));
        canvas.push(label.set("font-weight", "bold"));
    }
    for (name, start) in &world.starts {
        let tip = start.transform(Point::new(34.0 / canvas.scale(), 0.0));
        canvas.arrow(start.position(), tip, ACCENT);
        let dot = Outline::Circle { center: start.position(), radius: 4.5 / canvas.scale() };
        let dot = canvas.outline(&dot).set("fill", ACCENT);
        canvas.push(dot);
        let label = canvas.label(start.position(), (0.0, 19.0), 12.0, &format!("start {name}"));
        canvas.push(label.set("font-weight", "bold"));
    }
    canvas.axes();
    let subtitle =
        format!("{:.2} x {:.2} m, cut at {lidar_height} m above the floor", size.0, size.1);
    canvas.heading(&world.name, &subtitle);
    let mut legend: Vec<(String, &str, &str)> =
        layers.iter().map(|layer| ((*layer).to_owned(), grey(layer), INK)).collect();
    if missed {
        legend.push(("above or below the cut".to_owned(), "#fff", "#a8a8a8"));
    }
    for (kind, name, fill) in
        [(RegionKind::Room, "room", "#f3efe6"), (RegionKind::Corridor, "corridor", "#e6edf3")]
    {
        if world.regions.iter().any(|region| region.kind == kind) {
            legend.push((name.to_owned(), fill, FAINT));
        }
    }
    canvas.legend(&legend);
    canvas.finish(&format!("World {}", world.name))
}

/// The centroid of a simple polygon; the mean of its corners where it has no area.
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

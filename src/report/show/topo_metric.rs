//! A topo-metric map: places by name, and which of them are joined directly. Alone, or over the world that it is of.

use super::Drawing;
use crate::figure::canvas::{ACCENT, Canvas, FAINT, INK};
use crate::figure::svg::Element;
use crate::geometry::{Bounds, Outline};
use crate::studies::prior_map::tour::TopoMetricMap;
use crate::world::World;

/// Draws the map called `name` alone.
pub(super) fn drawn(name: &str, map: &TopoMetricMap) -> Drawing {
    drawing(name, map, &[], None)
}

/// Draws the map called `name` over `world` at `height` m.
pub(super) fn drawn_over(name: &str, map: &TopoMetricMap, world: &World, height: f64) -> Drawing {
    drawing(name, map, &world.slice(height), Some(&world.name))
}

fn drawing(name: &str, map: &TopoMetricMap, walls: &[Outline], world: Option<&str>) -> Drawing {
    let (nodes, edges) = (map.positions(), map.edges());
    let mut bounds = nodes.iter().fold(Bounds::EMPTY, |bounds, at| bounds.including(*at));
    for wall in walls {
        bounds = bounds.union(wall.bounds());
    }
    let span = bounds.width().max(bounds.height()).max(1.0);
    let mut canvas = Canvas::new(bounds.grown(0.07 * span), 1000.0, 760.0);
    canvas.raster();
    for wall in walls {
        let wall = canvas.outline(wall).set("fill", "#cfcfcf");
        canvas.push(wall);
    }
    for (a, b) in &edges {
        let line = canvas.path(&[*a, *b], false).set("fill", "none").set("stroke", ACCENT);
        canvas.push(line.set("stroke-width", 2));
    }
    for (at, node) in nodes.iter().zip(map.names()) {
        let (x, y) = canvas.at(*at);
        let dot = Element::new("circle").at("cx", x).at("cy", y).at("r", 5.0);
        canvas.push(dot.set("fill", "#fff").set("stroke", INK).set("stroke-width", 1.5));
        let label = canvas.label(*at, (0.0, -10.0), 11.0, node);
        canvas.push(label);
    }
    canvas.axes();
    let length: f64 = edges.iter().map(|(a, b)| a.distance(*b)).sum();
    let summary =
        format!("{} places, {} direct ways, {:.0} m together", nodes.len(), edges.len(), length);
    let title = name.rsplit('/').next().unwrap_or(name);
    canvas.heading(title, &summary);
    let mut legend =
        vec![("place".to_owned(), "#fff", INK), ("direct way".to_owned(), ACCENT, ACCENT)];
    if !walls.is_empty() {
        legend.push(("what stands there".to_owned(), "#cfcfcf", FAINT));
    }
    canvas.legend(&legend);
    let over = world.map_or_else(String::new, |world| format!("over the world: {world}\n"));
    Drawing {
        kind: super::Kind::TopoMetricMap,
        svg: canvas.finish(&format!("Topo-metric map {title}")),
        png: None,
        text: format!("topo-metric map: {name}\n{over}{summary}\nmeaning: {}\n", map.meaning()),
        warnings: Vec::new(),
    }
}

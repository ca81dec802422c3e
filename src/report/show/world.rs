//! A world cut at the lidar's height: layers told apart, regions, starts, goals and tags. Where its tags mean a graph, as
//! the deadline study's Figures 2 and 3: the building above, the graph below.

use super::graph::{Mark, badge, graph_sheet, legend_entry, star, tag_mark};
use super::graph_of;
use super::grid::cells_group;
use super::labels::{Taken, name_regions};
use super::prior::{NEAR, is_near};
use crate::figure::canvas::{ACCENT, Canvas, FAINT, INK, metres};
use crate::figure::cell_runs;
use crate::figure::svg::Element;
use crate::geometry::{Bounds, Cardinal, Outline, Point, convex_hull};
use crate::grid::{Cell, Occupancy, OccupancyGrid};
use crate::math;
use crate::world::topology::{TagScheme, Topology};
use crate::world::{Body, RegionKind, World};

/// Fills of the layers, walls first, then by name: told apart by hue, and in print by how dark they are.
const FILLS: [&str; 6] = ["#2b2b2b", "#8c8c8c", "#e0a458", "#4f6d8f", "#c9b8dd", "#6b8e4e"];

/// Fill of what a prior map holds to be occupied, where something solid is near.
const PRIOR_NEAR: &str = "#56b4e9";
/// The same where nothing is: darker, so that it is also told in grey.
const PRIOR_FAR: &str = "#b2182b";

/// Draws the world at `lidar_height` m, as an SVG file. What the plane misses is drawn as a thin outline.
pub fn world_svg(world: &World, lidar_height: f64) -> String {
    let graph = graph_of(world).and_then(Result::ok);
    let building = building_sheet(world, lidar_height, graph.as_ref(), None);
    let title = format!("World {}", world.name);
    match &graph {
        None => building.finish(&title),
        Some(graph) => building.finish_above(graph_sheet(world, graph, lidar_height), &title),
    }
}

/// Draws the building at `lidar_height` m under the occupied cells of `prior`, in one colour.
pub(super) fn world_under_svg(world: &World, lidar_height: f64, prior: &OccupancyGrid) -> String {
    building_sheet(world, lidar_height, None, Some(prior))
        .finish(&format!("World {} and prior map", world.name))
}

fn building_sheet(
    world: &World,
    lidar_height: f64,
    graph: Option<&Topology>,
    prior: Option<&OccupancyGrid>,
) -> Canvas {
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
    if let Some(prior) = prior {
        let occupied = |cell: &Cell| prior.at(*cell) == Occupancy::Occupied;
        for cell in prior.frame().cells().filter(occupied) {
            bounds = bounds.including(prior.frame().center(cell));
        }
    }
    let span = bounds.width().max(bounds.height());
    let mut canvas = Canvas::new(bounds.grown(0.03 * span), 1000.0, 760.0);
    canvas.raster();
    for region in &world.regions {
        let fill = if region.kind == RegionKind::Room { "#f3efe6" } else { "#e6edf3" };
        let area = canvas.path(&region.polygon, true).set("fill", fill);
        canvas.push(area);
    }
    let mut layers = world.layers();
    layers.sort_by_key(|name| (*name != "walls", *name));
    let fill_of = |layer: &str| {
        FILLS[layers.iter().position(|name| *name == layer).unwrap_or(0) % FILLS.len()]
    };
    let mut missed = false;
    let mut cut = Vec::new();
    for solid in &world.solids {
        let met = solid.body.slice(lidar_height);
        if !met.is_empty() {
            cut.extend(met.into_iter().map(|outline| (fill_of(&solid.layer), outline)));
            continue;
        }
        for outline in whole(&solid.body) {
            missed = true;
            let shape = canvas
                .outline(&outline)
                .set("fill", "none")
                .set("stroke", "#a8a8a8")
                .set("stroke-dasharray", "3 2");
            canvas.push(shape);
        }
    }
    let standing: Vec<Outline> = cut.iter().map(|(_, outline)| outline.clone()).collect();
    for (fill, outline) in cut {
        let shape = match &outline {
            // A table leg of 2 cm must not vanish.
            Outline::Circle { center, radius } => {
                let least = 1.2 / canvas.scale();
                canvas.outline(&Outline::Circle { center: *center, radius: radius.max(least) })
            }
            // Nor the surface of a mesh, which is a millimetre.
            Outline::Polygon(corners) if thickness(corners) * canvas.scale() < LEAST => {
                canvas.outline(&outline).set("stroke", fill).set("stroke-width", LEAST)
            }
            Outline::Polygon(_) => canvas.outline(&outline),
        };
        canvas.push(shape.set("fill", fill));
    }
    if let Some(prior) = prior {
        let [near, far] = [true, false].map(|wanted| {
            let is = |cell| {
                prior.at(cell) == Occupancy::Occupied && is_near(prior, &standing, cell) == wanted
            };
            Element::new("path").set("d", cell_runs(prior, |cell, _| is(cell)))
        });
        let near = near.set("fill", PRIOR_NEAR).set("fill-opacity", 0.7);
        let far = far.set("fill", PRIOR_FAR).set("stroke", PRIOR_FAR).set("stroke-width", 0.4);
        let group = cells_group(&canvas, prior.frame()).child(near).child(far);
        canvas.push(group);
    }
    let marks = marks(&canvas, world, graph);
    let mut taken = Taken { marks, solids: &standing };
    let key = name_regions(&mut canvas, &world.regions, &mut taken);
    match graph {
        Some(graph) => marked(&mut canvas, world, graph),
        None => unmarked(&mut canvas, world),
    }
    canvas.axes();
    let subtitle =
        format!("{:.2} x {:.2} m, cut at {lidar_height} m above the floor", size.0, size.1);
    canvas.heading(&world.name, &subtitle);
    if let Some(lacks) = lacks(world) {
        canvas.remark(&lacks);
    }
    let mut legend: Vec<(String, &str, &str)> =
        layers.iter().map(|layer| ((*layer).to_owned(), fill_of(layer), INK)).collect();
    if missed {
        legend.push(("above or below the cut".to_owned(), "#fff", "#a8a8a8"));
    }
    if prior.is_some() {
        legend.push((
            format!("prior, within {} m of a solid", metres(NEAR)),
            PRIOR_NEAR,
            PRIOR_NEAR,
        ));
        legend.push(("prior, farther off".to_owned(), PRIOR_FAR, PRIOR_FAR));
    }
    for (kind, name, fill) in
        [(RegionKind::Room, "room", "#f3efe6"), (RegionKind::Corridor, "corridor", "#e6edf3")]
    {
        if world.regions.iter().any(|region| region.kind == kind) {
            legend.push((name.to_owned(), fill, FAINT));
        }
    }
    if graph.is_some() {
        mark_legend(&mut canvas);
    } else {
        canvas.legend(&legend);
    }
    canvas.key(&key);
    canvas
}

/// Says how much of a world is missing, where anything is.
pub(super) fn lacks(world: &World) -> Option<String> {
    match world.missing() {
        0 => None,
        1 => Some("incomplete: 1 thing is missing".to_owned()),
        many => Some(format!("incomplete: {many} things are missing")),
    }
}

/// Least width (px) of what is solid.
const LEAST: f64 = 1.0;

/// Returns how thick (m) a long outline is.
fn thickness(corners: &[Point]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let (twice, round) = corners
        .iter()
        .zip(next)
        .fold((0.0, 0.0), |(twice, round), (a, b)| (twice + a.cross(*b), round + a.distance(*b)));
    if round > 0.0 { f64::abs(twice) / round } else { 0.0 }
}

/// Returns what is drawn of a body that the lidar misses: of a mesh not each of its faces, but what is around them.
fn whole(body: &Body) -> Vec<Outline> {
    let outlines = body.shadow(f64::NEG_INFINITY, f64::INFINITY);
    let Body::Mesh { .. } = body else { return outlines };
    let corners: Vec<Point> = outlines.iter().flat_map(|o| o.sides().map(|side| side.a)).collect();
    vec![Outline::Polygon(convex_hull(&corners))]
}

/// Returns what the names of regions keep off: tags, goals, and starts with what is written beside them.
fn marks(canvas: &Canvas, world: &World, graph: Option<&Topology>) -> Vec<Bounds> {
    let px = |at: Point, left: f64, right: f64, up: f64, down: f64| {
        let scale = canvas.scale();
        Bounds {
            min: at - Point::new(left / scale, down / scale),
            max: at + Point::new(right / scale, up / scale),
        }
    };
    let tags = world.tags.iter().map(|tag| px(tag.pose.position(), 6.0, 6.0, 6.0, 6.0));
    let starts = world.starts.iter().flat_map(|(name, start)| {
        let tip = start.transform(Point::new(34.0 / canvas.scale(), 0.0));
        #[expect(clippy::cast_precision_loss, reason = "names are short")]
        let half = if graph.is_some() { 6.0 } else { 3.4 * (name.chars().count() + 6) as f64 };
        [px(start.position(), half, half, 8.0, 22.0), px(tip, 8.0, 8.0, 8.0, 8.0)]
    });
    let stars = graph.map_or_else(Vec::new, |graph| goal_stars(canvas, graph));
    let stars = stars.into_iter().map(|at| px(at, 11.0, 11.0, 11.0, 11.0));
    let goals = world.goals.values().map(|at| px(*at, 26.0, 26.0, 22.0, 8.0));
    tags.chain(starts).chain(stars).chain(goals).collect()
}

/// Draws tags, goals and starts of a world without a graph, each with its name.
fn unmarked(canvas: &mut Canvas, world: &World) {
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
}

/// Draws tags by their meaning, starts by their letters, the goal as a star.
fn marked(canvas: &mut Canvas, world: &World, graph: &Topology) {
    for start in world.starts.values() {
        let tip = start.transform(Point::new(30.0 / canvas.scale(), 0.0));
        canvas.arrow(start.position(), tip, ACCENT);
    }
    let scheme = TagScheme::default();
    for tag in &world.tags {
        let facing = Cardinal::from_heading(tag.pose.heading);
        let mark = match &tag.color {
            color if *color == scheme.corridor => Mark::Vertex(GREEN),
            color if *color == scheme.room => Mark::Vertex(BLUE),
            color if *color == scheme.corridor_exit => Mark::Exit("#fff", facing),
            color if *color == scheme.door_exit => Mark::Exit(YELLOW, facing),
            _ => continue,
        };
        let name = format!("tag {} ({})", tag.id, tag.color);
        let mark = tag_mark(canvas.at(tag.pose.position()), mark);
        canvas.push(mark.child(Element::new("title").text(&name)));
    }
    for at in goal_stars(canvas, graph) {
        canvas.push(star(canvas.at(at), 10.0));
    }
    for (name, start) in &world.starts {
        let (x, y) = canvas.at(start.position());
        badge(canvas, (x + 10.5, y - 10.5), name);
    }
}

/// Returns where stars mark goals (m): behind the goal's vertex, seen from its door.
fn goal_stars(canvas: &Canvas, graph: &Topology) -> Vec<Point> {
    let star = |number: usize| {
        let vertex = &graph.vertices[number];
        let behind = vertex.exits.first().map_or(0.0, |exit| exit.direction.opposite().heading());
        let (sin, cos) = math::sin_cos(behind);
        vertex.at + Point::new(cos, sin) * (17.0 / canvas.scale())
    };
    graph.goals().map(star).collect()
}

/// Fills of vertex tags of corridors and rooms and of exits through doors, as the study shows them.
const GREEN: &str = "#2ca25f";
const BLUE: &str = "#3c6fd6";
const YELLOW: &str = "#f7d13d";

fn mark_legend(canvas: &mut Canvas) {
    let (mut x, y) = canvas.legend_at();
    for (mark, name) in [
        (Mark::Vertex(GREEN), "corridor tag"),
        (Mark::Vertex(BLUE), "room tag"),
        (Mark::Exit("#fff", Cardinal::East), "exit through a corridor"),
        (Mark::Exit(YELLOW, Cardinal::East), "exit through a door"),
    ] {
        let mark = tag_mark((x + 4.0, y), mark);
        x = legend_entry(canvas, x, mark, 8.0, name);
    }
    x = legend_entry(canvas, x, star((x + 8.0, y), 8.0), 16.0, "goal");
    let disc =
        Element::new("circle").at("cx", x + 7.0).at("cy", y).at("r", 7.0).set("fill", ACCENT);
    legend_entry(canvas, x, disc, 14.0, "start");
}

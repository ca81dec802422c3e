//! Grid maps: free white, occupied black, unknown grey.

use crate::figure::canvas::{Canvas, FAINT, INK, metres};
use crate::figure::svg::{Element, number};
use crate::geometry::{Bounds, Point};
use crate::grid::{Cell, GridFrame, Occupancy, OccupancyGrid};

/// Fill of free, occupied and unknown cells in drawings.
const FILLS: [(Occupancy, &str, &str); 3] = [
    (Occupancy::Free, "free", "#ffffff"),
    (Occupancy::Occupied, "occupied", "#111111"),
    (Occupancy::Unknown, "unknown", "#c9c9c9"),
];

/// Around the known part of a mostly unknown map (m).
const MARGIN: f64 = 1.0;

/// Draws the map called `name` with axes in metres, as an SVG file. Of a mostly unknown map only the known part is
/// drawn.
pub fn grid_svg(name: &str, whole: &OccupancyGrid) -> String {
    let grid = &known_part(whole);
    let frame = grid.frame();
    let mut canvas = Canvas::new(frame.bounds(), 900.0, 760.0);
    let mut group = cells_group(&canvas, frame);
    let ground = Element::new("rect").set("width", frame.width).set("height", frame.height);
    group.push(ground.set("fill", FILLS[0].2));
    for (value, _, fill) in &FILLS[1..] {
        let data = runs(grid, *value);
        if !data.is_empty() {
            group.push(Element::new("path").set("d", data).set("fill", fill));
        }
    }
    canvas.push(group);
    canvas.axes();
    let cropped = grid.values().len() < whole.values().len();
    let frame = whole.frame();
    let bounds = frame.bounds();
    let subtitle = format!(
        "{} x {} cells of {} m: {} x {} m from ({}, {}){}",
        frame.width,
        frame.height,
        frame.resolution,
        metres(bounds.width()),
        metres(bounds.height()),
        metres(frame.origin.x),
        metres(frame.origin.y),
        if cropped { "; its known part" } else { "" }
    );
    canvas.heading(name.rsplit('/').next().unwrap_or(name), &subtitle);
    let legend: Vec<(String, &str, &str)> = FILLS
        .iter()
        .filter(|(value, _, _)| whole.count(*value) > 0)
        .map(|(_, name, fill)| {
            ((*name).to_owned(), *fill, if *fill == "#111111" { INK } else { FAINT })
        })
        .collect();
    canvas.legend(&legend);
    canvas.finish(&format!("Grid map {name}"))
}

/// Creates a group whose unit is a cell, from the upper left corner of the grid `frame`.
pub(super) fn cells_group(canvas: &Canvas, frame: &GridFrame) -> Element {
    let (left, top) = canvas.at(Point::new(frame.origin.x, frame.bounds().max.y));
    let side = frame.resolution * canvas.scale();
    Element::new("g")
        .set("transform", format!("translate({} {}) scale({side})", number(left), number(top)))
        .set("shape-rendering", "crispEdges")
}

/// Returns the path data of the cells that are `value`, as runs along rows in units of cells.
pub(super) fn runs(grid: &OccupancyGrid, value: Occupancy) -> String {
    let mut data = String::new();
    for (row, cells) in rows(grid).enumerate() {
        let mut x = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            if run[0] == value {
                data.push_str(&format!("M{x} {row}h{}v1h-{}z", run.len(), run.len()));
            }
            x += run.len();
        }
    }
    data
}

/// Returns the part of a map that holds all known cells, where that is less than half of it; else all.
fn known_part(grid: &OccupancyGrid) -> OccupancyGrid {
    let frame = grid.frame();
    let mut known = Bounds::EMPTY;
    for cell in frame.cells().filter(|cell| grid.at(*cell) != Occupancy::Unknown) {
        known = known.including(frame.center(cell));
    }
    let part = known.grown(MARGIN.max(2.0 * frame.resolution));
    if known.is_empty()
        || part.width() * part.height() > 0.5 * frame.bounds().width() * frame.bounds().height()
    {
        return grid.clone();
    }
    let (low, high) = (frame.cell_at(part.min), frame.cell_at(part.max));
    let corner = frame.center(low) - Point::new(frame.resolution, frame.resolution) * 0.5;
    let cut = GridFrame {
        resolution: frame.resolution,
        origin: corner,
        width: high.x - low.x + 1,
        height: high.y - low.y + 1,
    };
    let cells =
        cut.cells().map(|cell| grid.at(Cell::new(cell.x + low.x, cell.y + low.y))).collect();
    OccupancyGrid::from_cells(cut, cells)
}

/// Writes the map as an 8-bit grey PNG with one pixel per cell, north up, in the greys of ROS's `map_saver`: 0
/// occupied, 254 free, 205 unknown.
pub fn grid_png(grid: &OccupancyGrid) -> Vec<u8> {
    let frame = grid.frame();
    let size = |cells: i32| u32::try_from(cells).unwrap_or(0);
    let pixels: Vec<u8> = rows(grid)
        .flatten()
        .map(|cell| match cell {
            Occupancy::Occupied => 0,
            Occupancy::Free => 254,
            Occupancy::Unknown => 205,
        })
        .collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size(frame.width), size(frame.height));
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    written.expect("a grid has at least one cell, and memory does not fail");
    file
}

/// Returns rows of cells from the north.
fn rows(grid: &OccupancyGrid) -> impl Iterator<Item = &[Occupancy]> {
    let width = usize::try_from(grid.frame().width).unwrap_or(0).max(1);
    grid.values().chunks(width).rev()
}

//! Maps whose origin is turned, along the world's axes.

use crate::geometry::{Bounds, Point, Pose};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};

/// Most cells of a map that was turned.
const MAX_CELLS: i64 = 1 << 24;

/// Draws `grid`, whose lower left corner is at `origin` and which is turned about it, anew in cells of the same size along
/// the world's axes. `None` where that takes too many of them.
///
/// A cell is what lies at its middle: of walls as thin as a cell none is lost, as neighbouring middles are a cell apart
/// and a turned cell is as wide; some corners are cut.
pub(super) fn along_the_axes(grid: &OccupancyGrid, origin: Pose) -> Option<OccupancyGrid> {
    let own = *grid.frame();
    let (width, height) =
        (f64::from(own.width) * own.resolution, f64::from(own.height) * own.resolution);
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let corners = corners.map(|(x, y)| origin.transform(Point::new(x, y)));
    let bounds = corners
        .into_iter()
        .fold(Bounds::EMPTY, |bounds, corner| bounds.union(Bounds { min: corner, max: corner }));
    let cells = |length: f64| {
        #[expect(clippy::cast_possible_truncation, reason = "at most the diagonal of the map")]
        let cells = (length / own.resolution - 1e-6).ceil() as i32;
        cells.max(1)
    };
    let frame = GridFrame {
        origin: bounds.min,
        width: cells(bounds.width()),
        height: cells(bounds.height()),
        ..own
    };
    if i64::from(frame.width) * i64::from(frame.height) > MAX_CELLS {
        return None;
    }
    let straight = GridFrame { origin: Point::ZERO, ..own };
    let at = |point: Point| grid.at(straight.cell_at(origin.inverse_transform(point)));
    let values: Vec<Occupancy> = frame.cells().map(|cell| at(frame.center(cell))).collect();
    Some(OccupancyGrid::from_cells(frame, values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use Occupancy::{Free, Occupied, Unknown};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_quarter_turn_moves_every_cell_to_its_place() {
        let frame = GridFrame { resolution: 0.5, origin: Point::ZERO, width: 3, height: 2 };
        let grid =
            OccupancyGrid::from_cells(frame, vec![Occupied, Free, Unknown, Free, Free, Occupied]);
        let turned = along_the_axes(&grid, Pose::new(10.0, 4.0, FRAC_PI_2)).unwrap();
        let found = *turned.frame();
        assert_eq!((found.width, found.height), (2, 3));
        assert!(found.origin.distance(Point::new(9.0, 4.0)) < 1e-9, "{found:?}");
        // Its x axis points north: the first row is the eastern column.
        assert_eq!(turned.values(), [Free, Occupied, Free, Free, Occupied, Unknown]);
    }

    #[test]
    fn a_turned_wall_keeps_its_place_and_its_length() {
        let frame = GridFrame { resolution: 0.05, origin: Point::ZERO, width: 100, height: 60 };
        let is_wall = |x: i32, y: i32| (30..32).contains(&y) && (10..90).contains(&x);
        let cells = frame.cells().map(|c| if is_wall(c.x, c.y) { Occupied } else { Free });
        let grid = OccupancyGrid::from_cells(frame, cells.collect());
        let origin = Pose::new(-3.0, 2.0, 0.4);
        let turned = along_the_axes(&grid, origin).unwrap();
        let (drawn, before) = (turned.count(Occupied), grid.count(Occupied));
        assert!(drawn.abs_diff(before) <= 4, "{drawn} of {before}");
        for i in 0..78 {
            let along = Point::new(0.525 + f64::from(i) * 0.05, 1.55);
            let cell = turned.frame().cell_at(origin.transform(along));
            assert_eq!(turned.at(cell), Occupied, "{i}");
        }
    }
}

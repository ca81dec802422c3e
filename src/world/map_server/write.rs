//! Maps in `map_saver`'s form, for maps that our robots made.

use crate::geometry::Pose;
use crate::grid::{Cell, Occupancy, OccupancyGrid};

/// Writes `grid` as a descriptor and the PGM image `image_name` that it names: [`super::read`] reads it back cell by
/// cell, as does ROS's `map_server`. The origin is the grid's own.
pub fn write(grid: &OccupancyGrid, image_name: &str) -> [Vec<u8>; 2] {
    let origin = grid.frame().origin;
    write_at(grid, Pose::new(origin.x, origin.y, 0.0), image_name)
}

/// Writes `grid` in the same way with its lower left corner at `origin`, about which it is turned.
pub fn write_at(grid: &OccupancyGrid, origin: Pose, image_name: &str) -> [Vec<u8>; 2] {
    let frame = grid.frame();
    let descriptor = format!(
        "image: {image_name}\nresolution: {:?}\norigin: [{:?}, {:?}, {:?}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        frame.resolution, origin.x, origin.y, origin.heading
    );
    let mut image = format!("P5\n{} {}\n255\n", frame.width, frame.height).into_bytes();
    // Images run from the top, grids from the bottom.
    for y in (0..frame.height).rev() {
        image.extend((0..frame.width).map(|x| match grid.at(Cell::new(x, y)) {
            Occupancy::Occupied => 0,
            Occupancy::Unknown => 205,
            Occupancy::Free => 254,
        }));
    }
    [descriptor.into_bytes(), image]
}

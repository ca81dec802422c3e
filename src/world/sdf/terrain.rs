//! Heightmaps: the ground's heights as a grey image, here a mesh as any other, of which a lidar meets what its plane cuts.
//!
//! As Gazebo has it: the image is a square with a side of 2^n + 1 pixels, its top at the largest y; the brightest pixel is as high as
//! `<size>` says, black lies at `<pos>`, the middle of the image too. Gazebo puts a point between every two pixels, which changes no
//! surface by more than the bend between them. Greys are taken in 256 steps, those of 16 bits too.

use crate::world::map_server::image;
use crate::world::mesh::{MAX_TRIANGLES, Mesh, Triangle};

/// Where a heightmap stands in its collision's frame, and how large it is (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) size: [f64; 3],
    pub(super) middle: [f64; 3],
}

/// The heights that an image draws.
#[derive(Debug)]
pub(super) struct Heights {
    /// Squares between pixels along a side.
    cells: usize,
    /// Row by row from the top.
    greys: Vec<u8>,
}

impl Heights {
    /// Reads an image.
    ///
    /// # Errors
    /// Why it draws no heights, to end a sentence.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let image = image::decode(bytes).map_err(|problem| problem.to_string())?;
        let side = u32::try_from(image.width.max(0)).unwrap_or_default();
        if image.width != image.height || side < 2 || !(side - 1).is_power_of_two() {
            return Err(format!(
                "its image has {} x {} pixels, expected a square with a side of 2^n + 1 (129, 257, 513)",
                image.width, image.height
            ));
        }
        let heights = Self {
            cells: (side - 1) as usize,
            greys: image.pixels.iter().map(|pixel| pixel.color[0]).collect(),
        };
        if heights.triangles() > MAX_TRIANGLES {
            return Err(format!("its image has a side of {side} pixels, expected at most 513"));
        }
        Ok(heights)
    }

    /// Returns how many triangles its surface has: two a square.
    pub(super) fn triangles(&self) -> usize {
        2 * self.cells * self.cells
    }

    /// Returns the surface.
    pub(super) fn surface(&self, extent: Extent) -> Mesh {
        let Self { cells, greys } = self;
        let brightest = f64::from(greys.iter().copied().fold(1, u8::max));
        let Extent { size, middle } = extent;
        let corner = |row: usize, column: usize| {
            #[expect(clippy::cast_precision_loss, reason = "at most 512")]
            let share = |n: usize| n as f64 / *cells as f64;
            [
                middle[0] + size[0] * (share(column) - 0.5),
                middle[1] + size[1] * (0.5 - share(row)),
                middle[2] + size[2] * f64::from(greys[row * (cells + 1) + column]) / brightest,
            ]
        };
        let squares = (0..*cells).flat_map(|row| (0..*cells).map(move |column| (row, column)));
        let triangles: Vec<Triangle> = squares
            .flat_map(|(row, column)| {
                let [a, b] = [corner(row, column), corner(row, column + 1)];
                let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
                [[a, c, b], [b, c, d]]
            })
            .collect();
        Mesh::new(triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent { size: [4.0, 2.0, 3.0], middle: [10.0, 0.0, -1.0] };

    fn surface(bytes: &[u8]) -> Mesh {
        Heights::read(bytes).unwrap().surface(EXTENT)
    }

    #[test]
    fn the_top_row_is_the_largest_y_and_the_brightest_pixel_the_height() {
        // One hill in the upper right corner, half as bright as a pixel can be.
        let mesh = surface(b"P2 3 3 255\n0 0 128\n0 0 0\n64 0 0\n");
        let high = |z: f64| {
            let corners = mesh.triangles().as_flattened();
            corners.iter().filter(|c| (c[2] - z).abs() < 1e-9).map(|c| [c[0], c[1]]).next()
        };
        assert_eq!((high(2.0), high(0.5)), (Some([12.0, 1.0]), Some([8.0, -1.0])));
        assert_eq!(mesh.triangles().len(), 8);
        // Black is flat, and divides by nothing.
        let flat = surface(b"P2 2 2 255\n0 0\n0 0\n");
        assert!(flat.triangles().as_flattened().iter().all(|corner| corner[2] == -1.0));
    }

    #[test]
    fn images_that_are_no_heights_are_told() {
        let told = |bytes: &[u8]| Heights::read(bytes).unwrap_err();
        let square = "expected a square with a side of 2^n + 1 (129, 257, 513)";
        assert_eq!(
            told(b"P2 3 2 9\n0 0 0 0 0 0\n"),
            format!("its image has 3 x 2 pixels, {square}")
        );
        assert_eq!(told(b"P2 1 1 9\n0\n"), format!("its image has 1 x 1 pixels, {square}"));
        let large = [b"P5 1025 1025 255\n".to_vec(), vec![0; 1025 * 1025]].concat();
        assert_eq!(told(&large), "its image has a side of 1025 pixels, expected at most 513");
        assert!(told(b"GIF89a").contains("GIF"));
    }
}

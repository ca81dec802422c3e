//! ROS `map_server` maps: a YAML descriptor and a grey image become an occupancy grid.
//!
//! Semantics after map_server 1.x (ROS wiki "map_server", section 1; `image_loader.cpp`), which nav2 keeps:
//! darkness p = (255 - grey) / 255, or grey / 255 where `negate`; above `occupied_thresh` occupied, below
//! `free_thresh` free, else unknown (`trinary`), a value between (`scale`), or the grey itself as the value
//! (`raw`). Bytes in, values out: the caller fetches the image.
//!
//! As in ROS, a key that means nothing here is no fault: it is warned of. A map whose origin is turned is drawn anew along
//! the world's axes (`turned`).

pub mod bag;
mod descriptor;
pub(super) mod image;
pub mod solid;
mod turned;
mod write;

pub use descriptor::Descriptor;
pub use write::{write, write_at};

use crate::document::{Diagnostic, Source};
use crate::grid::OccupancyGrid;

/// Readings on which programs differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// In trinary mode `map_server` averages the alpha channel with the colours: an opaque grey of 205 then
    /// reads as 217 and is free at the usual thresholds. `false` reads colours alone, as people mean them.
    pub average_alpha: bool,
}

impl Default for Options {
    /// Returns the options of `map_server`.
    fn default() -> Self {
        Self { average_alpha: true }
    }
}

/// Reads a map from its descriptor and the bytes of its image, whatever its descriptor says besides.
///
/// # Errors
/// Every fault of the descriptor; where there is none, the fault of the image.
pub fn read(
    yaml: &Source,
    image_name: &str,
    image: &[u8],
    options: Options,
) -> Result<OccupancyGrid, Vec<Diagnostic>> {
    Descriptor::read(yaml)?.map(image_name, image, options)
}

/// Returns whether `text` is a map's descriptor rather than another of our YAML documents.
pub fn is_descriptor(text: &str) -> bool {
    let has =
        |key: &str| text.lines().any(|line| line.trim_start_matches('\u{feff}').starts_with(key));
    has("image:") && has("resolution:")
}

#[cfg(test)]
mod tests;

//! ROS `map_server` maps: a YAML descriptor and a grey image become an occupancy grid.
//!
//! Semantics after map_server 1.x (ROS wiki "map_server", section 1; `image_loader.cpp`), which nav2 keeps:
//! darkness p = (255 - grey) / 255, or grey / 255 where `negate`; above `occupied_thresh` occupied, below
//! `free_thresh` free, else unknown (`trinary`), a value between (`scale`), or the grey itself as the value
//! (`raw`). Bytes in, values out: the caller fetches the image.

mod image;
mod write;

pub use write::write;

use crate::document::{self, Diagnostic, Parsed, Source};
use crate::geometry::Point;
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use image::Pixel;
use schemars::JsonSchema;
use serde::Deserialize;

/// A descriptor as `map_saver` writes it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MapDoc {
    /// Path of the image, relative to the descriptor.
    image: String,
    /// Side of a pixel (m).
    resolution: f64,
    /// Pose of the lower left pixel's lower left corner: x and y (m), yaw (rad).
    origin: [f64; 3],
    /// Darkness above which a pixel is occupied.
    occupied_thresh: f64,
    /// Darkness below which a pixel is free.
    free_thresh: f64,
    /// 1 where white is occupied, else 0.
    #[serde(default)]
    negate: u8,
    /// How greys between the thresholds are read.
    #[serde(default)]
    mode: Mode,
}

/// How greys between the thresholds are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Mode {
    /// As unknown.
    #[default]
    Trinary,
    /// As a probability.
    Scale,
    /// The grey is the value, 0 to 100; others are unknown.
    Raw,
}

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

/// From this value on (of 0 to 100) a cell of a `scale` or `raw` map is taken for occupied: more likely than not.
const LIKELY: f64 = 50.0;

/// Reads the path of the image that the descriptor names, as written.
///
/// # Errors
/// Every fault of the descriptor.
pub fn image_path(yaml: &Source) -> Result<String, Vec<Diagnostic>> {
    descriptor(yaml).map(|parsed| parsed.value.image)
}

/// Reads a map from its descriptor and the bytes of its image (PNG or PGM, recognised by their first bytes).
///
/// # Errors
/// Every fault of the descriptor; where there is none, the fault of the image.
pub fn read(
    yaml: &Source,
    image_name: &str,
    image: &[u8],
    options: Options,
) -> Result<OccupancyGrid, Vec<Diagnostic>> {
    let map = descriptor(yaml)?.value;
    let image = image::decode(image).map_err(|fault| {
        vec![
            Diagnostic::placeless(format!("cannot read the image `{image_name}`: {fault}"))
                .help("expected an 8 or 16 bit PNG, or a PGM (P2 or P5)"),
        ]
    })?;
    let frame = GridFrame {
        resolution: map.resolution,
        origin: Point::new(map.origin[0], map.origin[1]),
        width: image.width,
        height: image.height,
    };
    // Images run from the top, grids from the bottom.
    let width = usize::try_from(image.width).unwrap_or(1);
    let cells = image.pixels.chunks(width).rev().flatten();
    let cells = cells.map(|pixel| map.occupancy(*pixel, options)).collect();
    Ok(OccupancyGrid::from_cells(frame, cells))
}

fn descriptor(yaml: &Source) -> Result<Parsed<MapDoc>, Vec<Diagnostic>> {
    let parsed = document::parse::<MapDoc>(yaml)?;
    let map = &parsed.value;
    let mut faults = Vec::new();
    let mut expect = |holds: bool, pointer: &str, message: &str, expected: &str| {
        if !holds {
            faults.push(parsed.fault(pointer, message).label(format!("expected {expected}")));
        }
    };
    expect(
        map.resolution > 0.0 && map.resolution <= 100.0,
        "/resolution",
        "resolution out of range",
        "metres per pixel, above zero",
    );
    expect(
        map.origin.iter().all(|v| v.is_finite() && v.abs() < 1e6),
        "/origin",
        "origin out of range",
        "x and y in metres and yaw in radians",
    );
    // map_server itself warns that most readers ignore the yaw; a turned grid cannot be represented as one.
    expect(map.origin[2] == 0.0, "/origin/2", "turned maps cannot be read", "a yaw of 0");
    expect(map.negate <= 1, "/negate", "negate out of range", "0 or 1");
    expect(
        (0.0..=1.0).contains(&map.free_thresh),
        "/free_thresh",
        "threshold out of range",
        "a number from 0 to 1",
    );
    expect(
        map.occupied_thresh <= 1.0 && map.occupied_thresh > map.free_thresh,
        "/occupied_thresh",
        "threshold out of range",
        "a number above free_thresh and at most 1",
    );
    expect(!map.image.is_empty(), "/image", "no image", "the path of a PNG or PGM");
    if faults.is_empty() { Ok(parsed) } else { Err(faults) }
}

impl MapDoc {
    fn occupancy(&self, pixel: Pixel, options: Options) -> Occupancy {
        let grey = match pixel.alpha {
            Some(alpha) if options.average_alpha && self.mode == Mode::Trinary => {
                (pixel.color_sum() + f64::from(alpha)) / 4.0
            }
            _ => pixel.color_sum() / 3.0,
        };
        let grey = if self.negate == 1 { 255.0 - grey } else { grey };
        if self.mode == Mode::Raw {
            return match grey {
                value if value > 100.0 => Occupancy::Unknown,
                value if value >= LIKELY => Occupancy::Occupied,
                _ => Occupancy::Free,
            };
        }
        let darkness = (255.0 - grey) / 255.0;
        if darkness > self.occupied_thresh {
            Occupancy::Occupied
        } else if darkness < self.free_thresh {
            Occupancy::Free
        } else if self.mode == Mode::Trinary || pixel.alpha == Some(0) {
            Occupancy::Unknown
        } else {
            let ratio = (darkness - self.free_thresh) / (self.occupied_thresh - self.free_thresh);
            if 1.0 + 98.0 * ratio >= LIKELY { Occupancy::Occupied } else { Occupancy::Free }
        }
    }
}

#[cfg(test)]
mod tests;

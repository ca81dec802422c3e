//! The descriptor of a map: what its image's greys mean, and where it lies.

use super::image::{self, Pixel};
use super::{Options, turned};
use crate::document::{self, Diagnostic, Parsed, Source, known_or_near};
use crate::geometry::{Point, Pose};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use schemars::JsonSchema;
use serde::Deserialize;

/// The keys that mean something.
const KEYS: [&str; 7] =
    ["image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate", "mode"];

/// Largest yaw (rad) that is still none: over the 300 m of the largest map it moves a cell by less than a millimetre.
pub(super) const STRAIGHT: f64 = 1e-6;

/// How many times as many cells are walls as are floor where a map is doubtful.
const MOSTLY: usize = 2;

/// From this value on (of 0 to 100) a cell of a `scale` or `raw` map is taken for occupied: more likely than not.
const LIKELY: f64 = 50.0;

/// A descriptor as `map_saver` writes it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
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
    /// Whether white is occupied.
    #[serde(default)]
    negate: Negate,
    /// How greys between the thresholds are read.
    #[serde(default)]
    mode: Mode,
}

/// Whether white is occupied: 0 or 1 for ROS 1, also `true` or `false` since Nav2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged)]
enum Negate {
    Number(i64),
    Flag(bool),
}

impl Default for Negate {
    fn default() -> Self {
        Self::Flag(false)
    }
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

/// A map without its image.
#[derive(Debug, Clone)]
pub struct Descriptor {
    parsed: Parsed<MapDoc>,
    warnings: Vec<Diagnostic>,
}

impl Descriptor {
    /// Reads a descriptor.
    ///
    /// # Errors
    /// Every fault of it.
    pub fn read(yaml: &Source) -> Result<Self, Vec<Diagnostic>> {
        let parsed = document::parse::<MapDoc>(yaml)?;
        let faults = faults(&parsed);
        if !faults.is_empty() {
            return Err(faults);
        }
        let entries = parsed.tree.root.entries();
        let foreign = entries.iter().filter(|entry| !KEYS.contains(&entry.key.as_str()));
        let warnings = foreign.map(|entry| {
            let message = format!("`{}` means nothing to a map", entry.key);
            let fault = parsed.tree.fault(entry.key_place, message).label("left out, as in ROS");
            fault.help(known_or_near(&entry.key, &KEYS)).warning()
        });
        let warnings = warnings.collect();
        Ok(Self { parsed, warnings })
    }

    /// Returns the path of the image, relative to the descriptor, as written.
    pub fn image(&self) -> &str {
        &self.parsed.value.image
    }

    /// Returns warnings of what was left out.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Makes the map from the bytes of its image: a PNG or a picture of Netpbm (PGM, PPM, PBM), recognised by its first
    /// bytes.
    ///
    /// # Errors
    /// The fault of the image, or that of a turned map that would be too large.
    pub fn map(
        &self,
        image_name: &str,
        image: &[u8],
        options: Options,
    ) -> Result<OccupancyGrid, Vec<Diagnostic>> {
        let image = image::decode(image).map_err(|fault| {
            let message = format!("cannot read the image `{image_name}`: {fault}");
            vec![Diagnostic::placeless(message).help(fault.help(image_name))]
        })?;
        let [x, y, yaw] = self.parsed.value.origin;
        let frame = GridFrame {
            resolution: self.parsed.value.resolution,
            origin: Point::new(x, y),
            width: image.width,
            height: image.height,
        };
        // Images run from the top, grids from the bottom.
        let width = usize::try_from(image.width).unwrap_or(1);
        let cells = image.pixels.chunks(width).rev().flatten();
        let cells = cells.map(|pixel| self.occupancy(*pixel, options)).collect();
        let grid = OccupancyGrid::from_cells(frame, cells);
        if yaw.abs() <= STRAIGHT {
            return Ok(grid);
        }
        turned::along_the_axes(&grid, Pose::new(x, y, yaw)).ok_or_else(|| {
            let message = format!("the map of `{image_name}` is too large to be turned");
            vec![Diagnostic::placeless(message).help("write it with an origin whose yaw is 0")]
        })
    }

    /// Returns what is doubtful of its `map`, where something is: that most of what is known would be wall.
    pub fn doubt(&self, map: &OccupancyGrid) -> Option<Diagnostic> {
        let (walls, floor) = (map.count(Occupancy::Occupied), map.count(Occupancy::Free));
        (walls > MOSTLY * floor).then(|| {
            let message = format!("the map of `{}` is mostly wall", self.image());
            let label = format!("{walls} cells are occupied and {floor} free");
            let help =
                "in most maps white is free: is `negate` the wrong way round, or a threshold?";
            self.parsed.key_fault("/negate", message).label(label).help(help).warning()
        })
    }

    fn occupancy(&self, pixel: Pixel, options: Options) -> Occupancy {
        let map = &self.parsed.value;
        let grey = match pixel.alpha {
            Some(alpha) if options.average_alpha && map.mode == Mode::Trinary => {
                (pixel.color_sum() + f64::from(alpha)) / 4.0
            }
            _ => pixel.color_sum() / 3.0,
        };
        let negates = matches!(map.negate, Negate::Number(1) | Negate::Flag(true));
        let grey = if negates { 255.0 - grey } else { grey };
        if map.mode == Mode::Raw {
            return match grey {
                value if value > 100.0 => Occupancy::Unknown,
                value if value >= LIKELY => Occupancy::Occupied,
                _ => Occupancy::Free,
            };
        }
        let darkness = (255.0 - grey) / 255.0;
        if darkness > map.occupied_thresh {
            Occupancy::Occupied
        } else if darkness < map.free_thresh {
            Occupancy::Free
        } else if map.mode == Mode::Trinary || pixel.alpha == Some(0) {
            Occupancy::Unknown
        } else {
            let ratio = (darkness - map.free_thresh) / (map.occupied_thresh - map.free_thresh);
            if 1.0 + 98.0 * ratio >= LIKELY { Occupancy::Occupied } else { Occupancy::Free }
        }
    }
}

/// Returns every value out of its range.
fn faults(parsed: &Parsed<MapDoc>) -> Vec<Diagnostic> {
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
    let [x, y, yaw] = map.origin;
    let lies = [x, y].iter().all(|v| v.is_finite() && v.abs() < 1e6);
    expect(lies, "/origin", "origin out of range", "x and y in metres and yaw in radians");
    expect(
        yaw.abs() <= std::f64::consts::TAU,
        "/origin/2",
        "the map is turned by more than once around",
        "a yaw in radians: is this in degrees?",
    );
    expect(
        matches!(map.negate, Negate::Number(0 | 1) | Negate::Flag(_)),
        "/negate",
        "negate out of range",
        "0, 1, true or false",
    );
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
    expect(!map.image.is_empty(), "/image", "no image", "the path of a picture");
    faults
}

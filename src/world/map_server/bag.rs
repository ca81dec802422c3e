//! The occupancy grid of a bag: `nav_msgs/msg/OccupancyGrid` in an MCAP file, as `ros2 bag record --storage mcap` and
//! `reenact replay --mcap` write it. The last message of its topic counts.

pub(crate) mod framing;

use super::descriptor::STRAIGHT;
use super::turned;
use crate::geometry::{Point, Pose};
use crate::grid::{GridFrame, Occupancy, OccupancyGrid};
use crate::math;
use std::collections::BTreeMap;
use thiserror::Error;

/// The names of the message: ROS 2, and ROS 1 for the message that says so.
const MESSAGES: [&str; 2] = ["nav_msgs/msg/OccupancyGrid", "nav_msgs/OccupancyGrid"];
/// How ROS 2 writes messages.
const ENCODING: &str = "cdr";
/// The topic of a map in ROS, taken where there are several.
const USUAL_TOPIC: &str = "/map";
/// Values (of 0 to 100) above and below which `map_server` takes a cell for occupied and for free.
const THRESHOLDS: [i8; 2] = [65, 19];
/// Largest grid read (cells).
const MAX_CELLS: u64 = 1 << 23;
/// How an MCAP file begins.
const MAGIC: &[u8] = b"\x89MCAP";

/// Why a bag gives no map.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum BagError {
    /// It is no MCAP file, or is damaged.
    #[error(
        "it cannot be read: {0}; where it is compressed by lz4, write it anew with `mcap compress --compression zstd`"
    )]
    Unreadable(String),
    /// There is no grid in it.
    #[error("it holds no nav_msgs/msg/OccupancyGrid; its topics are {0}")]
    NoGrid(String),
    /// There are several.
    #[error("it holds grids on several topics, {0}; choose one with `topic`")]
    Several(String),
    /// The topic asked for holds none.
    #[error("its topic `{topic}` holds no nav_msgs/msg/OccupancyGrid; those that do are {known}")]
    NoTopic {
        /// The topic asked for.
        topic: String,
        /// Those that hold grids.
        known: String,
    },
    /// It is of ROS 1 or another middleware.
    #[error(
        "its grid is encoded as `{0}`, expected `cdr`; convert the bag to ROS 2 (`pip install rosbags`, `rosbags-convert`)"
    )]
    Encoding(String),
    /// The message is not what its type says.
    #[error("the grid on `{0}` is damaged")]
    Damaged(String),
}

/// Returns whether `bytes` begin as an MCAP file does.
pub fn is_bag(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Returns the messages of a bag, chunks taken apart: for tests of what writes bags.
#[cfg(test)]
pub(crate) fn plain(bytes: &[u8]) -> Vec<u8> {
    framing::messages(bytes).unwrap_or_else(|e| panic!("{e}"))
}

/// Reads the last grid on `topic`; where none is asked for, on the one topic that holds grids, or on `/map`.
///
/// # Errors
/// Where there is no such grid.
pub fn read_bag(bytes: &[u8], topic: Option<&str>) -> Result<OccupancyGrid, BagError> {
    let unreadable = |error: mcap::McapError| BagError::Unreadable(error.to_string());
    let messages = framing::messages(bytes).map_err(BagError::Unreadable)?;
    let mut topics: BTreeMap<String, bool> = BTreeMap::new();
    let mut last: BTreeMap<String, (String, Vec<u8>)> = BTreeMap::new();
    for message in mcap::MessageStream::new(&messages).map_err(unreadable)? {
        let message = message.map_err(unreadable)?;
        let channel = &message.channel;
        let is_grid =
            channel.schema.as_ref().is_some_and(|schema| MESSAGES.contains(&schema.name.as_str()));
        topics.insert(channel.topic.clone(), is_grid);
        if is_grid && topic.is_none_or(|topic| topic == channel.topic) {
            let content = (channel.message_encoding.clone(), message.data.into_owned());
            last.insert(channel.topic.clone(), content);
        }
    }
    let listed = |of_grids: bool| {
        let names = topics.iter().filter(|(_, is_grid)| !of_grids || **is_grid);
        let names: Vec<String> = names.map(|(name, _)| format!("`{name}`")).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    if last.len() > 1 {
        last.retain(|name, _| name == USUAL_TOPIC);
        if last.is_empty() {
            return Err(BagError::Several(listed(true)));
        }
    }
    let Some((name, (encoding, data))) = last.pop_first() else {
        return Err(match topic {
            Some(topic) => BagError::NoTopic { topic: topic.to_owned(), known: listed(true) },
            None => BagError::NoGrid(listed(false)),
        });
    };
    if encoding != ENCODING {
        return Err(BagError::Encoding(encoding));
    }
    grid(&data).ok_or(BagError::Damaged(name))
}

/// Reads the message.
fn grid(data: &[u8]) -> Option<OccupancyGrid> {
    let mut message = Cdr::of(data)?;
    // std_msgs/Header: stamp and frame.
    message.bytes::<4>(4)?;
    message.bytes::<4>(4)?;
    let name = message.length()?;
    message.skip(name)?;
    // nav_msgs/MapMetaData.
    message.bytes::<4>(4)?;
    message.bytes::<4>(4)?;
    let resolution = f64::from(f32::from_bits(message.word()?));
    let (width, height) = (message.word()?, message.word()?);
    let [x, y, _, _, _, qz, qw] = [0; 7].map(|_: i32| message.double());
    let (x, y, qz, qw) = (x?, y?, qz?, qw?);
    let yaw = 2.0 * math::atan2(qz, qw);
    let cells = message.length()?;
    let data = message.take(cells)?;
    let area = u64::from(width) * u64::from(height);
    let is_sound = resolution > 0.0
        && resolution <= 100.0
        && [x, y, yaw].iter().all(|v| v.is_finite() && v.abs() < 1e6)
        && (1..=MAX_CELLS).contains(&area)
        && u64::try_from(cells).is_ok_and(|cells| cells == area);
    if !is_sound {
        return None;
    }
    // Single precision says 0.05 as 0.0500000007: what was meant has few digits.
    let resolution = (resolution * 1e6).round() / 1e6;
    let frame = GridFrame {
        resolution,
        origin: Point::new(x, y),
        width: width.try_into().ok()?,
        height: height.try_into().ok()?,
    };
    let occupancy = |value: &u8| match i8::from_ne_bytes([*value]) {
        value if value < 0 => Occupancy::Unknown,
        value if value >= THRESHOLDS[0] => Occupancy::Occupied,
        value if value <= THRESHOLDS[1] => Occupancy::Free,
        _ => Occupancy::Unknown,
    };
    let grid = OccupancyGrid::from_cells(frame, data.iter().map(occupancy).collect());
    if yaw.abs() <= STRAIGHT {
        return Some(grid);
    }
    turned::along_the_axes(&grid, Pose::new(x, y, yaw))
}

/// A message of OMG's Common Data Representation, read from its start.
struct Cdr<'a> {
    data: &'a [u8],
    at: usize,
    is_little: bool,
}

impl<'a> Cdr<'a> {
    fn of(data: &'a [u8]) -> Option<Self> {
        let (head, data) = data.split_at_checked(4)?;
        Some(Self { data, at: 0, is_little: head[1] & 1 == 1 })
    }

    /// Returns the next bytes, which begin at a multiple of `aligned`, in the order of this machine.
    fn bytes<const N: usize>(&mut self, aligned: usize) -> Option<[u8; N]> {
        self.at = self.at.next_multiple_of(aligned);
        let mut bytes: [u8; N] = self.take(N)?.try_into().ok()?;
        if self.is_little != cfg!(target_endian = "little") {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn word(&mut self) -> Option<u32> {
        self.bytes::<4>(4).map(u32::from_ne_bytes)
    }

    fn double(&mut self) -> Option<f64> {
        self.bytes::<8>(8).map(f64::from_ne_bytes)
    }

    fn length(&mut self) -> Option<usize> {
        self.word()?.try_into().ok()
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.data.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(taken)
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.take(count).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths that no sum of lengths can hold.
    #[test]
    fn a_record_longer_than_its_file_is_refused() {
        let mut bag = b"\x89MCAP0\r\n".to_vec();
        bag.push(0xfe);
        bag.extend(u64::MAX.to_le_bytes());
        let longer = BagError::Unreadable("a record says that it is longer than it is".to_owned());
        assert_eq!(read_bag(&bag, None).unwrap_err(), longer);
    }
}

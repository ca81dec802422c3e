//! MCAP with CDR messages: the one door to the container and to the encoding.

use super::definitions::definition;
use super::messages::{Message, nanoseconds};
use super::packed::packed;
use byteorder::LittleEndian;
use mcap::records::{MessageHeader, Metadata};
use mcap::{WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Encapsulation header of little-endian plain CDR (DDSI-RTPS 2.5, section 10.2), as `rmw` writes it.
const CDR_LE: [u8; 4] = [0, 1, 0, 0];

/// Topics of which the last message stays true: who plays a bag offers it to those who come late.
const LATCHED: [&str; 5] = ["/map", "/prior_map", "/robot_description", "/tf_static", "/world"];

/// Returns the quality of service that `topic` was offered with, as rosbag2 keeps it (a list of `rmw` profiles in YAML), so that a
/// bag plays with it: all but the latched topics as the default profile of ROS 2.
fn offered_qos(topic: &str) -> String {
    // The numbers of rmw/types.h: reliable 1; transient local 1, volatile 2; keep last 1.
    let (depth, durability) = if LATCHED.contains(&topic) { (1, 1) } else { (10, 2) };
    let forever = "\n    sec: 9223372036\n    nsec: 854775807\n";
    format!(
        "- history: 1\n  depth: {depth}\n  reliability: 1\n  durability: {durability}\n  deadline:{forever}  lifespan:{forever}  liveliness: 1\n  \
         liveliness_lease_duration:{forever}  avoid_ros_namespace_conventions: false\n"
    )
}

/// Why a bag cannot be written, which is a bug.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// The container refuses a record.
    #[error(transparent)]
    Container(#[from] mcap::McapError),
    /// A message cannot be encoded.
    #[error(transparent)]
    Message(#[from] cdr_encoding::Error),
    /// The container's own bytes are not as it says.
    #[error(
        "the bag's records cannot be compressed: they are not as the MCAP specification has them"
    )]
    Unpackable,
}

/// A bag in the making.
pub(super) struct BagWriter {
    writer: Writer<Cursor<Vec<u8>>>,
    channels: BTreeMap<&'static str, (u16, u32)>,
}

impl BagWriter {
    /// Creates an empty bag. Nothing in it shows when or where it was written.
    pub(super) fn new() -> Result<Self, BagError> {
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("reenact ", env!("CARGO_PKG_VERSION")))
            .compression(None);
        let writer = options.create(Cursor::new(Vec::new()))?;
        Ok(Self { writer, channels: BTreeMap::new() })
    }

    /// Appends `message` on `topic`, at the simulated time `time_s`.
    pub(super) fn write<M: Message>(
        &mut self,
        topic: &'static str,
        time_s: f64,
        message: &M,
    ) -> Result<(), BagError> {
        let (channel_id, sequence) = match self.channels.get(topic) {
            Some((id, count)) => (*id, *count),
            None => (self.open::<M>(topic)?, 0),
        };
        self.channels.insert(topic, (channel_id, sequence + 1));
        let mut bytes = CDR_LE.to_vec();
        bytes.extend(cdr_encoding::to_vec::<M, LittleEndian>(message)?);
        let time = nanoseconds(time_s);
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        Ok(self.writer.write_to_known_channel(&header, &bytes)?)
    }

    /// Writes the metadata record `name` with those `entries` that say something; none where none does.
    pub(super) fn tell(&mut self, name: &str, entries: &[(&str, &str)]) -> Result<(), BagError> {
        let told = entries.iter().filter(|(_, value)| !value.is_empty());
        let metadata: BTreeMap<String, String> =
            told.map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        if metadata.is_empty() {
            return Ok(());
        }
        let record = Metadata { name: name.to_owned(), metadata };
        Ok(self.writer.write_metadata(&record)?)
    }

    fn open<M: Message>(&mut self, topic: &'static str) -> Result<u16, BagError> {
        // Where ROS 2 names a type, `msg` stands between package and type.
        let name = M::TYPE.replace('/', "/msg/");
        let schema = self.writer.add_schema(&name, "ros2msg", definition(M::TYPE).as_bytes())?;
        let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), offered_qos(topic))]);
        Ok(self.writer.add_channel(schema, topic, "cdr", &metadata)?)
    }

    /// Returns the file's bytes, and how many messages each topic has.
    pub(super) fn finish(mut self) -> Result<(Vec<u8>, BTreeMap<&'static str, u32>), BagError> {
        self.writer.finish()?;
        let counts = self.channels.into_iter().map(|(topic, (_, count))| (topic, count));
        let plain = self.writer.into_inner().into_inner();
        Ok((packed(&plain).ok_or(BagError::Unpackable)?, counts.collect()))
    }
}

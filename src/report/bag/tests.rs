use super::super::fixtures::recording;
use super::*;
use crate::robot::{self, Scan, Twist};
use crate::studies::recording::{ActionView, GraphView, VertexView};
use crate::units::Tick;
use crate::world::map_server::bag::plain;
use mcap::MessageStream;
use std::collections::BTreeSet;

/// Records ten seconds of driving with a scan every 50 ms, and a graph.
fn sensing() -> Recording {
    let mut recording = recording(100);
    let tick = Tick::period_of(20.0).unwrap();
    let sensed = (0..200_u64).map(|i| {
        let stamp = Tick(i * tick.0);
        let x = 0.05 * stamp.seconds().get();
        Sensed {
            scan: Scan {
                stamp,
                mount: Pose::new(0.1, 0.0, 0.0),
                min_angle: -1.0,
                increment: 0.5,
                min_range: 0.1,
                max_range: 4.0,
                ranges: vec![1.0, 2.5, f64::INFINITY, 0.5, 3.0],
            },
            odometry: robot::Odometry {
                stamp,
                pose: Pose::new(x, 0.0, 0.2),
                twist: Twist { linear: 0.05, angular: 0.0 },
            },
            believed: Pose::new(x + 0.3, 0.1, 0.25),
        }
    });
    recording.sensed = Some(sensed.collect());
    (recording.description, recording.scan_height_m) = ("<robot name=\"r\"/>".to_owned(), 0.25);
    let vertex = |label: &str, x: f64| VertexView {
        label: label.into(),
        room: label.starts_with('R'),
        goal: false,
        at: Point::new(x, 1.0),
        unexplored: vec![0.0],
    };
    recording.frames[10].graph = Some(GraphView {
        vertices: vec![vertex("R1", 0.0), vertex("c1a", 2.0)],
        edges: vec![(0, 1)],
        policy: vec![ActionView { from: 0, to: 1, probability: 0.5, fast: true }],
        target: Some(1),
        ..GraphView::default()
    });
    recording.frames[10].path = Some(vec![Point::ZERO, Point::new(1.0, 1.0)]);
    recording
}

#[test]
fn every_topic_is_there_with_its_type_and_in_order_of_time() {
    let bag = bag(&sensing(), None).unwrap();
    let (mut types, mut last) = (BTreeMap::new(), 0);
    for message in MessageStream::new(&plain(&bag.bytes)).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!(
            (schema.encoding.as_str(), message.channel.message_encoding.as_str()),
            ("ros2msg", "cdr")
        );
        assert!(message.log_time >= last, "{}", message.channel.topic);
        last = message.log_time;
        assert_eq!(message.data[..4], [0, 1, 0, 0]);
        *types.entry((message.channel.topic.clone(), schema.name.clone())).or_insert(0_u32) += 1;
    }
    let told: Vec<String> =
        types.iter().map(|((topic, kind), count)| format!("{topic} {kind} {count}")).collect();
    assert_eq!(
        told,
        [
            "/clock rosgraph_msgs/msg/Clock 100",
            "/coverage std_msgs/msg/Float64 100",
            "/distance_travelled std_msgs/msg/Float64 100",
            "/frontiers visualization_msgs/msg/MarkerArray 10",
            "/graph visualization_msgs/msg/MarkerArray 1",
            "/ground_truth/pose geometry_msgs/msg/PoseStamped 100",
            "/map nav_msgs/msg/OccupancyGrid 11",
            "/odom nav_msgs/msg/Odometry 200",
            "/plan nav_msgs/msg/Path 10",
            "/prior_map nav_msgs/msg/OccupancyGrid 1",
            "/robot_description std_msgs/msg/String 1",
            "/rosout rcl_interfaces/msg/Log 10",
            "/scan sensor_msgs/msg/LaserScan 200",
            "/tf tf2_msgs/msg/TFMessage 200",
            "/tf_static tf2_msgs/msg/TFMessage 1",
            "/world visualization_msgs/msg/MarkerArray 1",
        ]
    );
    let counted: u32 = bag.counts.values().sum();
    assert_eq!(counted, types.values().sum::<u32>());
}

#[test]
fn what_stays_true_is_offered_to_those_who_come_late() {
    let mut recording = sensing();
    recording.deadline_s = Some(30.0);
    recording.outcome = "late".to_owned();
    let bag = bag(&recording, None).unwrap();
    let mut durable = BTreeMap::new();
    for message in MessageStream::new(&plain(&bag.bytes)).unwrap() {
        let channel = message.unwrap().channel;
        let profiles = &channel.metadata["offered_qos_profiles"];
        durable.insert(channel.topic.clone(), profiles.contains("durability: 1\n"));
    }
    let latched: Vec<&str> =
        durable.iter().filter(|(_, is)| **is).map(|(topic, _)| topic.as_str()).collect();
    assert_eq!(latched, ["/map", "/prior_map", "/robot_description", "/tf_static", "/world"]);
    let last = MessageStream::new(&plain(&bag.bytes)).unwrap().map(Result::unwrap).last().unwrap();
    assert_eq!(last.channel.topic, "/rosout");
    assert!(last.data.windows(21).any(|text| text == b"the trial ended: late"));
    let left = MessageStream::new(&plain(&bag.bytes))
        .unwrap()
        .map(Result::unwrap)
        .find(|message| message.channel.topic == "/time_left")
        .unwrap();
    let first = recording.frames[0].time_s;
    assert_eq!(left.data[4..12], (30.0 - first).to_le_bytes());
}

#[test]
fn a_scan_is_laid_out_as_common_data_representation_has_it() {
    let bag = bag(&sensing(), None).unwrap();
    let scan = MessageStream::new(&plain(&bag.bytes))
        .unwrap()
        .map(Result::unwrap)
        .find(|message| message.channel.topic == "/scan")
        .unwrap();
    let at = |i: usize| f32::from_le_bytes(scan.data[i..i + 4].try_into().unwrap());
    // Encapsulation 4; stamp 8; "laser" with length and end 4 + 6, padded to 12; seven floats; the number of ranges.
    assert_eq!(scan.data[12..16], 6_u32.to_le_bytes());
    assert_eq!(&scan.data[16..22], b"laser\0");
    assert_eq!((at(24), at(28), at(32)), (-1.0, 1.0, 0.5));
    assert_eq!((at(44), at(48)), (0.1, 4.0));
    assert_eq!(scan.data[52..56], 5_u32.to_le_bytes());
    assert_eq!((at(56), at(60), at(64)), (1.0, 2.5, f32::INFINITY));
    assert_eq!(scan.data.len(), 56 + 5 * 4 + 4);
}

#[test]
fn the_scanner_stands_at_its_height_and_the_robot_is_described() {
    let bag = bag(&sensing(), None).unwrap();
    let of = |topic: &str| {
        let bytes = plain(&bag.bytes);
        let mut all = MessageStream::new(&bytes).unwrap().map(Result::unwrap);
        all.find(|message| message.channel.topic == topic).unwrap()
    };
    // Encapsulation 4; length with end 4 and 18 bytes.
    let described = of("/robot_description");
    assert_eq!(described.data[4..8], 18_u32.to_le_bytes());
    assert_eq!(&described.data[8..26], b"<robot name=\"r\"/>\0");
    let still = of("/tf_static");
    let height = 0.25_f64.to_le_bytes();
    assert_eq!(still.data.windows(8).filter(|bytes| *bytes == height).count(), 1);
}

#[test]
fn no_two_poses_are_of_one_instant() {
    let mut recording = sensing();
    let mut again = recording.frames[99].clone();
    again.event = Some("over".to_owned());
    recording.frames.push(again);
    let counts = bag(&recording, None).unwrap().counts;
    assert_eq!((counts["/ground_truth/pose"], counts["/clock"]), (100, 100));
    assert_eq!(counts["/rosout"], bag(&sensing(), None).unwrap().counts["/rosout"] + 1);
}

#[test]
fn thinned_scans_keep_their_rate_and_nothing_else_is_lost() {
    let all = bag(&sensing(), None).unwrap();
    let thinned = bag(&sensing(), Some(5.0)).unwrap();
    assert_eq!((all.counts["/scan"], thinned.counts["/scan"]), (200, 50));
    assert_eq!(all.counts["/odom"], thinned.counts["/odom"]);
    assert!(plain(&thinned.bytes).len() < plain(&all.bytes).len());
}

#[test]
fn the_same_recording_gives_the_same_bytes_and_an_empty_one_a_bag() {
    assert_eq!(bag(&sensing(), None).unwrap().bytes, bag(&sensing(), None).unwrap().bytes);
    let empty = bag(&Recording::default(), None).unwrap();
    assert_eq!(empty.counts.keys().copied().collect::<Vec<_>>(), ["/tf_static", "/world"]);
}

/// Checks that the map in a bag of ours is that of the recording: whoever maps with ROS has such a bag.
#[test]
fn the_map_in_a_bag_is_read_back() {
    use crate::world::map_server::bag::{BagError, read_bag};
    let recording = sensing();
    let bytes = bag(&recording, None).unwrap().bytes;
    let (map, made) = (read_bag(&bytes, None).unwrap(), recording.final_map().unwrap());
    assert_eq!(map.values(), made.values());
    let (found, frame) = (map.frame(), made.frame());
    assert_eq!((found.width, found.height), (frame.width, frame.height));
    assert!((found.resolution - frame.resolution).abs() < 1e-9);
    assert!(found.origin.distance(frame.origin) < 1e-9);
    assert_eq!(read_bag(&bytes, Some("/map")).unwrap().values(), made.values());
    let prior = read_bag(&bytes, Some("/prior_map")).unwrap();
    assert_eq!(prior.values(), recording.prior.as_ref().unwrap().values());
    let wrong = read_bag(&bytes, Some("/grid")).unwrap_err();
    assert!(
        matches!(&wrong, BagError::NoTopic { known, .. } if known.contains("`/map`")),
        "{wrong}"
    );
    for cut in (0..bytes.len()).step_by(bytes.len() / 97) {
        let mut damaged = bytes.clone();
        damaged[cut] ^= 0x55;
        // Read or refused; never worse.
        let _ = (read_bag(&bytes[..cut], None), read_bag(&damaged, None));
    }
}

#[test]
fn a_bag_says_which_trial_it_is_by_the_labels_of_its_study() {
    let mut recording = sensing();
    recording.name = "none/0".to_owned();
    recording.title = "no prior, trial 0".to_owned();
    recording.outcome = "gave-up".to_owned();
    let bytes = bag_under_banner(&recording, None, Some("NOT CHECKED")).unwrap().bytes;
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let told = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
    let told: Vec<(&str, &str)> =
        told.metadata.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    assert_eq!(
        told,
        [
            ("banner", "NOT CHECKED"),
            ("outcome", "gave-up"),
            ("title", "no prior, trial 0"),
            ("trial", "none/0"),
        ]
    );
    let lines: Vec<_> = MessageStream::new(&plain(&bytes))
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/rosout")
        .collect();
    let has = |i: usize, text: &str| {
        lines[i].data.windows(text.len()).any(|part| part == text.as_bytes())
    };
    assert!(has(0, "no prior, trial 0") && has(lines.len() - 1, "the trial ended: gave up"));
}

#[test]
fn chunks_are_compressed_and_every_index_points_at_what_it_names() {
    let bytes = bag_under_banner(&sensing(), None, Some("NOT CHECKED")).unwrap().bytes;
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let mut channels = BTreeSet::new();
    for index in &summary.chunk_indexes {
        let at = usize::try_from(index.chunk_start_offset).unwrap();
        let length = usize::try_from(index.chunk_length).unwrap();
        let chunk = mcap::parse_record(bytes[at], &bytes[at + 9..at + length]).unwrap();
        let mcap::records::Record::Chunk { header, data } = chunk else {
            panic!("no chunk at {at}")
        };
        assert_eq!((header.compression.as_str(), index.compression.as_str()), ("zstd", "zstd"));
        assert_eq!(header.compressed_size, index.compressed_size);
        assert_eq!(data.len() as u64, index.compressed_size);
        assert!(index.compressed_size < index.uncompressed_size);
        for (channel, at) in &index.message_index_offsets {
            let at = usize::try_from(*at).unwrap();
            // Kind 7 is a message index; behind the head stands the channel.
            let found = (bytes[at], u16::from_le_bytes([bytes[at + 9], bytes[at + 10]]));
            assert_eq!(found, (7, *channel));
            channels.insert(*channel);
        }
    }
    assert_eq!(channels.len(), 16, "every topic has an index");
    let index = &summary.metadata_indexes[0];
    assert_eq!(mcap::read::metadata(&bytes, index).unwrap().name, "reenact");
    // Both checksums, by the rule of the specification.
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let long = |at: usize| {
        usize::try_from(u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())).unwrap()
    };
    let footer = bytes.len() - 8 - 29;
    let start = long(footer + 9);
    assert_eq!(bytes[footer], 2);
    assert_eq!(word(footer + 25), crc32fast::hash(&bytes[start..footer + 25]));
    let data_end = start - 13;
    assert_eq!((bytes[data_end], word(data_end + 9)), (15, crc32fast::hash(&bytes[..data_end])));
    // The groups of the summary lie one after the other, each of records of its kind.
    let (mut at, mut next) = (long(footer + 17), start);
    while bytes[at] == 14 {
        let (group, begins) = (bytes[at + 9], long(at + 10));
        assert_eq!((begins, bytes[begins]), (next, group));
        next = begins + long(at + 18);
        at += 9 + long(at + 1);
    }
    assert_eq!((next, at), (long(footer + 17), footer));
}

"""Reads a bag with the readers that others wrote and says what is in it; fails where one cannot, or finds something else.

    read_bag.py BAG.mcap TOPIC...

Every TOPIC must be there. The messages are decoded by mcap-ros2-support and, a second time, by rosbags. Frames are those of REP-105,
and the robot's description has the frames that the bag moves. evo reads the true trajectory: its length along the arcs between the
poses is the distance that the trial's record has, within a millimetre. Beside the bag stands a layout for Foxglove that names topics of
the bag alone. Chunks are compressed by zstd, and every checksum and index holds. Needs PyPI's mcap, mcap-ros2-support, rosbags and evo.
"""

import collections
import json
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
from evo.core.trajectory import PoseTrajectory3D
from mcap.reader import SeekingReader
from mcap.records import Chunk, DataEnd, Footer
from mcap.stream_reader import StreamReader
from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader

bag = Path(sys.argv[1])
counts = collections.Counter()
last = -1
parents, laser_z, links = {}, None, None
for message in read_ros2_messages(str(bag)):
    assert message.log_time_ns >= last, "messages are out of order"
    last = message.log_time_ns
    topic, ros = message.channel.topic, message.ros_msg
    counts[topic] += 1
    if topic == "/scan":
        beams = round((ros.angle_max - ros.angle_min) / ros.angle_increment) + 1
        assert len(ros.ranges) == beams, f"{len(ros.ranges)} ranges, {beams} beams"
        assert ros.header.frame_id == "laser"
    elif topic in ("/map", "/prior_map"):
        assert len(ros.data) == ros.info.width * ros.info.height
        assert set(ros.data) <= {-1, 0, 100}
    elif topic == "/tf":
        frames = [(t.header.frame_id, t.child_frame_id) for t in ros.transforms]
        assert frames == [("map", "odom"), ("odom", "base_link")], frames
        for transform in ros.transforms:
            q = transform.transform.rotation
            assert math.isclose(q.z * q.z + q.w * q.w, 1.0, rel_tol=1e-9) and q.x == q.y == 0.0
    elif topic == "/robot_description":
        robot = ElementTree.fromstring(ros.data)
        links = {link.get("name") for link in robot.findall("link")}
        laser_z = float(robot.find("joint/origin").get("xyz").split()[2])
    if topic in ("/tf", "/tf_static"):
        for transform in ros.transforms:
            child, parent = transform.child_frame_id, transform.header.frame_id
            assert parents.setdefault(child, parent) == parent, f"{child} has two parents"
            if child == "laser":
                height = transform.transform.translation.z
for topic, count in sorted(counts.items()):
    print(f"{topic}: {count}")
missing = set(sys.argv[2:]) - set(counts)
assert not missing, f"missing: {sorted(missing)}"

# The container: every checksum (of each chunk unpacked, of the data, of the summary) is there and holds, read from end to end and by
# the indices; chunks are compressed, and each lies where its index says.
content = bag.read_bytes()
with bag.open("rb") as file:
    records = list(StreamReader(file, emit_chunks=True, validate_crcs=True).records)
chunks = [record for record in records if isinstance(record, Chunk)]
assert chunks and {chunk.compression for chunk in chunks} == {"zstd"}
assert all(chunk.uncompressed_crc for chunk in chunks)
assert all(record.data_section_crc for record in records if isinstance(record, DataEnd))
assert all(record.summary_crc for record in records if isinstance(record, Footer))
with bag.open("rb") as file:
    reader = SeekingReader(file, validate_crcs=True)
    summary = reader.get_summary()
    assert len(summary.chunk_indexes) == len(chunks)
    for index, chunk in zip(summary.chunk_indexes, chunks):
        at = index.chunk_start_offset
        assert content[at] == 6 and int.from_bytes(content[at + 1 : at + 9], "little") + 9 == index.chunk_length
        sizes = (index.compressed_size, index.uncompressed_size)
        assert sizes == (len(chunk.data), chunk.uncompressed_size) and index.compression == "zstd"
        ends = index.chunk_start_offset + index.chunk_length
        assert all(content[offset] == 7 and offset >= ends for offset in index.message_index_offsets.values())
    sought = collections.Counter(channel.topic for _, channel, _ in reader.iter_messages())
    assert sought == counts and summary.statistics.message_count == sum(counts.values())
    told = {record.name: record.metadata for record in reader.iter_metadata()}["reenact"]
assert set(told) == {"trial", "title", "outcome"}, told
plain = sum(chunk.uncompressed_size for chunk in chunks)
print(f"trial: {told['trial']} ({told['title']}), {told['outcome']}; {plain} bytes as {len(content)}")

# REP-105: from the robot's sensor to the map, each frame with one parent; above it the truth's.
chain, frame = [], "laser"
while frame:
    chain.append(frame)
    frame = parents.get(frame)
assert chain == ["laser", "base_link", "odom", "map", "world"], chain
assert links == {"base_link", "laser"} and laser_z == height, (links, laser_z, height)

# The same bag by readers of another family.
again, poses, distance = collections.Counter(), [], None
with AnyReader([bag]) as reader:
    for connection, stamp, raw in reader.messages():
        again[connection.topic] += 1
        if connection.topic in ("/ground_truth/pose", "/distance_travelled"):
            ros = reader.deserialize(raw, connection.msgtype)
            if connection.topic == "/distance_travelled":
                distance = ros.data
            else:
                at, q = ros.pose.position, ros.pose.orientation
                poses.append((stamp / 1e9, [at.x, at.y, at.z], [q.w, q.x, q.y, q.z]))
assert again == counts, f"rosbags counts otherwise: {again - counts}, {counts - again}"

stamps, positions, turns = (np.array(part) for part in zip(*poses))
way = PoseTrajectory3D(positions, turns, stamps)
valid, why = way.check()
assert valid, why
# Between two poses the robot drives an arc; evo adds up the chords.
chords = np.diff(way.distances)
half = np.diff(np.unwrap(2 * np.arctan2(turns[:, 3], turns[:, 0]))) / 2
arcs = float(np.sum(chords / np.sinc(half / np.pi)))
print(f"way: {arcs:.4f} m along arcs, {way.path_length:.4f} m along chords, {distance:.4f} m in the record")
assert abs(arcs - distance) < 0.001, "the trajectory is not as long as the record says"

layout = json.loads(bag.with_suffix(".foxglove-layout.json").read_text())
panels = layout["configById"]
named = set(panels["3D!scene"]["topics"]) | {panels["3D!scene"]["layers"]["robot"]["topic"]}
named |= {path["value"].removesuffix(".data") for panel in panels.values() for path in panel.get("paths", [])}
assert named <= set(counts), f"the layout names {sorted(named - set(counts))}"

"""Reads a bag with the readers that others wrote and says what is in it; fails where a message cannot be decoded.

    read_bag.py BAG.mcap TOPIC...

Every TOPIC must be there. Needs PyPI's mcap and mcap-ros2-support.
"""

import collections
import math
import sys

from mcap_ros2.reader import read_ros2_messages

counts = collections.Counter()
last = -1
for message in read_ros2_messages(sys.argv[1]):
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
for topic, count in sorted(counts.items()):
    print(f"{topic}: {count}")
missing = set(sys.argv[2:]) - set(counts)
assert not missing, f"missing: {sorted(missing)}"

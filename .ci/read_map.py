#!/usr/bin/env python3
"""Reads a map as map_server does, with PyYAML and Pillow, and says how much of it is wall, floor and unknown.

    .ci/read_map.py MAP.yaml LEAST_FREE_M2
"""
import sys
from pathlib import Path

import yaml
from PIL import Image

descriptor = Path(sys.argv[1])
least = float(sys.argv[2])
found = yaml.safe_load(descriptor.read_text())
assert set(found) == {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}, found
assert len(found["origin"]) == 3 and found["negate"] == 0
image = Image.open(descriptor.parent / found["image"])
assert image.mode == "L", image.mode
counts = {"wall": 0, "free": 0, "unknown": 0}
for number, grey in image.getcolors():
    darkness = (255 - grey) / 255
    kind = "wall" if darkness > found["occupied_thresh"] else "free" if darkness < found["free_thresh"] else "unknown"
    counts[kind] += number
area = {kind: round(number * found["resolution"] ** 2, 1) for kind, number in counts.items()}
print(f"{descriptor}: {image.width} x {image.height} cells, m2: {area}")
assert area["free"] >= least and area["wall"] > 0, area

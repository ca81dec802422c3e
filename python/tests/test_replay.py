"""Replays, held against what the command writes of the same trial."""

from __future__ import annotations

from pathlib import Path

import numpy
import pytest

import reenact
from conftest import PUBLISHED, Command


def test_a_trial_comes_out_as_archived(tiny: str) -> None:
    bundle = reenact.run(tiny).bundle
    replay = bundle.replay("floor-plan/1")
    assert replay.same and replay.name == "floor-plan/1"
    trials = bundle.trials("polars")
    (row,) = trials.filter(trials["key"] == replay.key).to_dicts()
    assert (row["prior"], row["trial"], row["outcome"]) == ("floor-plan", 1, replay.outcome)
    assert replay.times.shape == replay.distance.shape == replay.coverage.shape == (len(replay.poses),)
    assert replay.poses.shape == (len(replay.times), 3) and (numpy.diff(replay.times) >= 0).all()
    assert replay.distance[-1] == pytest.approx(row["distance-m"], abs=0.05)
    # The way is the sum of its steps, as far as the frames lie apart.
    steps = numpy.hypot(*numpy.diff(replay.poses[:, :2], axis=0).T)
    assert steps.sum() == pytest.approx(replay.distance[-1], rel=0.02)
    assert "record as archived" in repr(replay) and replay._repr_svg_().startswith("<svg")
    assert replay.prior is not None and {0, 100} <= set(numpy.unique(replay.prior.cells))
    assert bundle.replay("none/0").prior is None
    with pytest.raises(reenact.NotUnderstood, match="^error: .*none/99"):
        bundle.replay("none/99")


def test_the_map_is_the_one_that_the_command_writes(published: reenact.Bundle, command: Command) -> None:
    written = command("replay", str(PUBLISHED), "none/0", "--unchecked", "--map", "map.yaml")
    assert written.returncode in (0, 1), written.stderr
    head, size, depth, image = Path("map.pgm").read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    pixels = numpy.frombuffer(image, "u1").reshape(height, width)[::-1]
    replay = published.replay("none/0")
    ours = replay.map
    assert ours.cells.shape == pixels.shape and ours.cells.dtype == numpy.int8
    for value, grey in ((-1, 205), (0, 254), (100, 0)):
        assert ((ours.cells == value) == (pixels == grey)).all(), value
    known = [int((replay.map_at(float(time)).cells != -1).sum()) for time in replay.times[:: len(replay.times) // 5]]
    assert known == sorted(known) and 0 < known[-1] <= (ours.cells != -1).sum()
    # Beams end within the building, which is as large as the map.
    time, ends = replay.beam_ends[0]
    assert time == replay.times[0] and ends.ndim == 2 and ends.shape[1] == 2 and len(ends) > 10
    reach = max(ours.cells.shape) * ours.resolution
    assert (numpy.abs(ends - replay.poses[0, :2]) < reach).all()


def test_scans_are_kept_where_they_are_asked_for(published: reenact.Bundle) -> None:
    with pytest.raises(reenact.NotUnderstood) as none:
        published.replay("none/0").scans
    assert str(none.value) == "the replay kept no scans: ask for them with replay(trial, scans=True)"
    scans = published.replay("none/0", scans=True).scans
    assert scans.ranges.shape == (len(scans.times), len(scans.angles)) and len(scans.times) > 100
    assert scans.odometry.shape == scans.believed.shape == (len(scans.times), 3)
    hit = scans.ranges[numpy.isfinite(scans.ranges)]
    assert scans.limits[0] <= hit.min() and hit.max() <= scans.limits[1]
    assert (numpy.diff(scans.angles) > 0).all() and (numpy.diff(scans.times) > 0).all()

"""A trial that was re-enacted, as arrays."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Mapping, Optional

from reenact._errors import NotUnderstood

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]
    Cells = npt.NDArray[np.int8]

#: Columns of what `Replay.poses` and its neighbours are cut from.
_TIME, _POSE, _DISTANCE, _COVERAGE = 0, slice(1, 4), 4, 5
_FRAME_COLUMNS, _SENSED_COLUMNS = 6, 14


def _numpy() -> Any:
    try:
        import numpy
    except ModuleNotFoundError as missing:
        raise NotUnderstood("a replay is arrays of numpy, which is not installed: pip install numpy") from missing
    return numpy


@dataclass(frozen=True)
class Map:
    """An occupancy grid, as ROS has it (``nav_msgs/OccupancyGrid``)."""

    #: One row for each row of cells, the lowest first: -1 unknown, 0 free, 100 occupied.
    cells: Cells
    #: Side of a cell (m).
    resolution: float
    #: Lower left corner (m), in the map's own frame.
    origin: tuple[float, float]
    #: Where the map's frame lies in the world: x, y (m), heading (rad).
    pose: tuple[float, float, float]


@dataclass(frozen=True)
class Scans:
    """Every scan as the sensor gave it, one row a scan."""

    #: Seconds of simulated time.
    times: Floats
    #: Metres by scan and beam; infinity where nothing was hit.
    ranges: Floats
    #: Direction (rad) of every beam, in the sensor's frame.
    angles: Floats
    #: Where the sensor is on the robot: x, y (m), heading (rad).
    mount: tuple[float, float, float]
    #: Shortest and longest range (m) that it reports.
    limits: tuple[float, float]
    #: Where the robot was by its wheels: x, y (m), heading (rad), in the frame in which it began.
    odometry: Floats
    #: Where it took itself to be: the same, in the frame of its map.
    believed: Floats


class Replay:
    """One trial with everything written down. Times are seconds of simulated time; places are metres in the world."""

    def __init__(self, told: Mapping[str, Any]) -> None:
        numpy = _numpy()
        self._told = told
        #: ``CONDITION/NUMBER``.
        self.name: str = told["name"]
        #: The trial's key, 64 hexadecimal digits.
        self.key: str = told["key"]
        #: Whether the record came out as the archived one.
        self.same: bool = told["same"]
        #: How it ended, how its next place is chosen, what it decided when, the true world and the robot's outline.
        self.details: Mapping[str, Any] = json.loads(told["details"])
        frames = numpy.frombuffer(told["frames"], "<f8").reshape(-1, _FRAME_COLUMNS)
        #: When each frame is.
        self.times: Floats = frames[:, _TIME]
        #: The true pose in each: x, y, heading (rad).
        self.poses: Floats = frames[:, _POSE]
        #: The way travelled until then (m).
        self.distance: Floats = frames[:, _DISTANCE]
        #: Coverage then (percent).
        self.coverage: Floats = frames[:, _COVERAGE]

    def __repr__(self) -> str:
        record = "as archived" if self.same else "NOT as archived"
        return f"Replay({self.name!r}, {self.outcome} after {self.times[-1]:.1f} s, {len(self.times)} frames, record {record})"

    def _repr_svg_(self) -> str:
        svg: str = self._told["svg"]
        return svg

    @property
    def outcome(self) -> str:
        """How the trial ended."""
        outcome: str = self.details["outcome"]
        return outcome

    @property
    def map(self) -> Map:
        """The robot's own map at the end; all unknown where it made none."""
        return self.map_at(float(self.times[-1]))

    def map_at(self, time: float) -> Map:
        """Returns the robot's own map as it was at `time`."""
        numpy = _numpy()
        resolution, x, y, width, height = self._told["map_frame"]
        cells = numpy.full(width * height, -1, numpy.int8)
        frame, index, value = numpy.frombuffer(self._told["map_changes"], "<i8").reshape(-1, 3).T
        known = frame < numpy.searchsorted(self.times, time, "right")
        # Of several changes of a cell the last counts.
        cells[index[known]] = value[known]
        return Map(cells.reshape(height, width), resolution, (x, y), self._told["map_pose"])

    @property
    def prior(self) -> Optional[Map]:
        """The map that the robot knew before, in the world's frame; none where it knew none."""
        if "prior" not in self._told:
            return None
        resolution, x, y, width, height = self._told["prior_frame"]
        cells = _numpy().frombuffer(self._told["prior"], "i1").reshape(height, width)
        return Map(cells, resolution, (x, y), (0.0, 0.0, 0.0))

    @cached_property
    def beam_ends(self) -> list[tuple[float, Floats]]:
        """Where beams ended when a scan went into the map: the time, and x, y of every few beams."""
        numpy = _numpy()
        points = numpy.frombuffer(self._told["scan_points"], "<f8").reshape(-1, 2)
        parts = numpy.split(points, numpy.cumsum(self._told["scan_sizes"])[:-1])
        return [(float(self.times[frame]), part) for frame, part in zip(self._told["scan_frames"], parts)]

    @cached_property
    def scans(self) -> Scans:
        """Every scan; `NotUnderstood` where the replay was not asked for them."""
        if "ranges" not in self._told:
            raise NotUnderstood("the replay kept no scans: ask for them with replay(trial, scans=True)")
        numpy = _numpy()
        sensed = numpy.frombuffer(self._told["sensed"], "<f8").reshape(-1, _SENSED_COLUMNS)
        beams = self._told["range_sizes"][0] if len(sensed) else 0
        ranges = numpy.frombuffer(self._told["ranges"], "<f8").reshape(len(sensed), beams)
        first = sensed[0] if len(sensed) else numpy.zeros(_SENSED_COLUMNS)
        return Scans(
            times=sensed[:, 0],
            ranges=ranges,
            angles=first[4] + first[5] * numpy.arange(beams),
            mount=(float(first[1]), float(first[2]), float(first[3])),
            limits=(float(first[6]), float(first[7])),
            odometry=sensed[:, 8:11],
            believed=sensed[:, 11:14],
        )

"""A bundle, read as it was checked."""

from __future__ import annotations

import csv
import io
import json
import os
from functools import cached_property
from pathlib import Path
from typing import Any, Iterator, Mapping, Optional, Union

from reenact import _frames, _html, _reenact
from reenact._errors import NotUnderstood, raise_for
from reenact._frames import Field, Library
from reenact._replay import Replay

#: Where something is.
PathLike = Union[str, "os.PathLike[str]"]

_TABLES = "results/tables/"
_FIGURES = "results/figures/"


def _asked(call: Any, *arguments: Any) -> Any:
    """Calls the extension, and raises what it refuses as what it stands for."""
    try:
        return call(*arguments)
    except _reenact.Refused as refused:
        code, text = refused.args
    raise_for(code, text)


class Figure:
    """A figure of a bundle. A notebook draws it."""

    def __init__(self, id: str, svg: str) -> None:
        self.id = id
        self.svg = svg

    def __repr__(self) -> str:
        return f"Figure({self.id!r}, {len(self.svg)} characters of SVG)"

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: PathLike) -> None:
        """Writes the SVG."""
        Path(path).write_text(self.svg, encoding="utf-8")


class _Files(Mapping[str, Any]):
    """Files of one folder and kind, by their names without it; each is read when it is asked for."""

    def __init__(self, bundle: Bundle, folder: str, ending: str) -> None:
        self._bundle = bundle
        self._paths = {
            path[len(folder) : -len(ending)]: path
            for path in bundle.files
            if path.startswith(folder) and path.endswith(ending)
        }

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self)})"

    def _path(self, name: str) -> str:
        if name not in self._paths:
            raise KeyError(f"{name}: expected one of {', '.join(self) or 'none, for the bundle has no such files'}")
        return self._paths[name]


class Tables(_Files):
    """The tables of a study as frames, by the ids that its manifest gives them."""

    def __getitem__(self, name: str) -> Any:
        return self._bundle.frame(self._path(name))


class Figures(_Files):
    """The figures of a study, by the ids that its manifest gives them. A notebook draws them all."""

    def __getitem__(self, name: str) -> Figure:
        return Figure(name, self._bundle.read(self._path(name)).decode("utf-8"))

    def _repr_html_(self) -> str:
        return "".join(_html.figure(name, self[name].svg) for name in self)


class Bundle:
    """A sealed bundle: a zip or a folder.

    It is checked to `level` first, 0 to 3 as ``reenact verify`` counts them, and refused (`BundleError`) where it is not
    what it says; `unchecked` goes on all the same, and `holds` then says that it is not. Frames are those of `frames`,
    ``"pandas"`` or ``"polars"``, or of the first of them that is installed.
    """

    def __init__(
        self, path: PathLike, *, level: int = 3, unchecked: bool = False, frames: Optional[Library] = None
    ) -> None:
        if not 0 <= level <= 3:
            raise NotUnderstood(
                f"error: a bundle is opened at level 0 to 3, found {level}; `verify` executes trials again"
            )
        self.path = Path(path)
        self._frames = frames
        self._archive: _reenact.Archive = _asked(_reenact.Archive, self.path, level, unchecked)

    def __repr__(self) -> str:
        return f"Bundle({str(self.path)!r}, {self.results_digest[:15]}...)"

    @property
    def name(self) -> str:
        """The study's short name."""
        return self._archive.name

    @cached_property
    def title(self) -> str:
        """The study's title."""
        title: str = _asked(self._archive.title)
        return title

    @property
    def engine(self) -> str:
        """The version of the engine that ran it: trials repeat bit for bit under the same one."""
        return self._archive.engine

    @property
    def partial(self) -> bool:
        """Whether only a part of the study was run: then no claim is judged."""
        return self._archive.partial

    @property
    def checked(self) -> str:
        """What checking it found, on one line."""
        return self._archive.checked

    @property
    def holds(self) -> bool:
        """Whether it is what it says, as far as it was checked."""
        return self._archive.holds

    @property
    def results_digest(self) -> str:
        """What came out: the same for everyone who runs the same study with the same engine."""
        return self._archive.results_digest

    @property
    def study_digest(self) -> str:
        """What was asked."""
        return self._archive.study_digest

    @property
    def bundle_id(self) -> Optional[str]:
        """This very bundle; a bare crate has no such id."""
        return self._archive.bundle_id

    @cached_property
    def finding(self) -> str:
        """What was found, in a sentence or two: the first thing that the bundle's page says."""
        finding: str = _asked(self._archive.finding)
        return finding

    @cached_property
    def files(self) -> Mapping[str, int]:
        """The size in bytes of every file, by its path in ``data/``."""
        return dict(self._archive.files())

    def read(self, path: str) -> bytes:
        """Returns the bytes of the file at `path` in ``data/``."""
        data: Optional[bytes] = _asked(self._archive.read, path)
        if data is None:
            raise NotUnderstood(f"error: the bundle has no file `{path}`; `files` lists those that it has")
        return data

    @cached_property
    def dictionary(self) -> Mapping[str, Any]:
        """The resources of ``datapackage.json`` by path: what every column of every CSV file means."""
        package = json.loads(self.read("datapackage.json"))
        return {resource["path"]: resource for resource in package["resources"]}

    def _columns(self, path: str) -> list[Field]:
        """Returns what the data dictionary knows of the columns of a file; a file that it does not know has none."""
        return _frames.fields(self.dictionary[path]) if path in self.dictionary else []

    def frame(self, path: str, frames: Optional[Library] = None) -> Any:
        """Returns the CSV file at `path` in ``data/`` as a frame, with the types that the data dictionary states."""
        return _frames.read_csv(self.read(path), self._columns(path), frames or self._frames)

    def trials(self, frames: Optional[Library] = None) -> Any:
        """Returns one row a trial: its key, factors, number, outcome and measures."""
        return self.frame("results/trials.csv", frames)

    def series(self, frames: Optional[Library] = None) -> Any:
        """Returns one row for each point of the trials' curves of coverage; `NotUnderstood` where the study has none.

        A bundle so large that it has no ``results/series.csv`` has them in its records, from which they are then taken.
        """
        path = "results/series.csv"
        if path in self.files:
            return self.frame(path, frames)
        told: Optional[str] = _asked(self._archive.series)
        if told is None:
            raise NotUnderstood(f"error: the study of `{self.name}` records no curves")
        # They repeat columns of the trials, whose types are known; all others are numbers.
        return _frames.read_csv(told.encode(), self._columns("results/trials.csv"), frames or self._frames)

    @property
    def claims(self) -> Any:
        """One row a claim: whose it is, its words, the verdict, what the paper's own table says of it."""
        return self._judged("results/claims.csv", self._archive.claims())

    @property
    def comparisons(self) -> Any:
        """One row a comparison that a verdict rests on: effect, interval, p-values; `claim` joins it to the claims."""
        return self._judged("results/comparisons.csv", self._archive.comparisons())

    def _judged(self, path: str, told: str) -> Any:
        return _frames.read_csv(told.encode(), self._columns(path), self._frames)

    @property
    def tables(self) -> Tables:
        """The study's tables, each cell's number of ours and the paper's: frames by id."""
        return Tables(self, _TABLES, ".csv")

    @property
    def figures(self) -> Figures:
        """The study's figures, by id."""
        return Figures(self, _FIGURES, ".svg")

    @property
    def trial_names(self) -> list[str]:
        """The name of every trial, ``CONDITION/NUMBER``, in plan order."""
        names: list[str] = _asked(self._archive.trials)
        return names

    def replay(self, trial: str, *, scans: bool = False) -> Replay:
        """Re-enacts a trial with everything written down, and says whether its record came out as archived.

        `trial` is its name or at least eight digits of its key; with `scans` every scan is kept as the sensor gave it. Needs
        numpy.
        """
        return Replay(_asked(self._archive.replay, trial, scans))

    def _repr_html_(self) -> str:
        claims = list(csv.DictReader(io.StringIO(self._archive.claims())))
        return _html.bundle(self, claims, {name: figure.svg for name, figure in self.figures.items()})

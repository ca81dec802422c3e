"""``reenact run``, for one manifest."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Mapping, NoReturn, Optional, Sequence, Union

from reenact._bundle import Bundle, PathLike
from reenact._call import Answer, call
from reenact._errors import Failed, Fault, ManifestError, raise_for
from reenact._progress import Wanted, listener

#: Values of a factor: one, or several.
Values = Union[str, float, Sequence[Union[str, float]]]


@dataclass(frozen=True)
class Run:
    """A finished run. It is true where it does not differ from the lock that it was held against."""

    #: Where the bundle is.
    path: Path
    results_digest: str
    study_digest: str
    bundle_id: str
    trials: int
    #: Of them, those that the store had.
    cached: int
    #: Whether only a part of the study was run: then no claim is judged.
    partial: bool
    #: Simulated time of all trials (s).
    sim_seconds: float
    wall_seconds: float
    #: Verdicts by claim: ``supported``, ``contradicted``, ``inconclusive``, ``cannot-be-tested``.
    claims: Mapping[str, str]
    #: How it differs from the lock, with `locked`.
    drift: Optional[Mapping[str, Any]]
    #: What was said besides: warnings of the manifest, notes.
    notes: str = ""
    #: The whole answer (``schemas/answers/run.schema.json``).
    answer: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __bool__(self) -> bool:
        return self.drift is None

    @cached_property
    def bundle(self) -> Bundle:
        """The bundle, checked and opened."""
        return Bundle(self.path)

    def _repr_html_(self) -> str:
        return self.bundle._repr_html_()


def run(
    manifest: PathLike,
    *,
    out: PathLike = "artifacts",
    only: Optional[Mapping[str, Values]] = None,
    trials: Optional[int] = None,
    set: Optional[Mapping[str, Any]] = None,
    shard: Optional[str] = None,
    allow: Sequence[PathLike] = (),
    jobs: Optional[int] = None,
    cache: bool = True,
    locked: bool = False,
    twice: bool = False,
    capsule: bool = False,
    progress: Wanted = None,
) -> Run:
    """Simulates every trial of `manifest` and seals a bundle in `out`.

    `only` (values by factor), `trials` (per condition) and `shard` (``"1/4"``) run a part of the study, `set` replaces values of
    the manifest by path (``{"world.file": "other.yaml"}``), `allow` lists folders from which files may be read that robots and
    worlds name, `cache` says whether finished trials are kept and found again, `locked` holds the run against the lock beside
    the manifest, `twice` executes every trial twice to find what does not repeat, `capsule` seals the program's source.

    `progress` is told how far it is: a bar where tqdm is installed, or a function (`Progress`), or nothing with ``False``.

    Ctrl-C, or a notebook's stop, ends it at once with `KeyboardInterrupt`, which says how many trials are kept: the same call
    goes on where it was.

    Raises `ManifestError` with every fault of the manifest, `NotUnderstood` for the rest of the request, and `Failed`.
    """
    changed = [f"--set={path}={_value(value)}" for path, value in (set or {}).items()]
    changed += [f"--allow={_path(folder)}" for folder in allow]
    words = ["run", "--format=json", f"--out={_path(out)}", *changed]
    for factor, values in (only or {}).items():
        several = [values] if isinstance(values, (str, int, float)) else values
        words.append(f"--only={factor}={','.join(map(str, several))}")
    options = {"trials": trials, "shard": shard, "jobs": jobs}
    words += [f"--{name}={value}" for name, value in options.items() if value is not None]
    flags = {"no-cache": not cache, "locked": locked, "twice": twice, "capsule": capsule}
    words += [f"--{name}" for name, wanted in flags.items() if wanted]
    ended = call([*words, "--", _path(manifest)], listener(progress))
    if ended.answer is None:
        _refuse(ended, changed, manifest)
    told = ended.answer
    if ended.code > 1:
        raise Failed(ended.told, told)
    return Run(
        path=Path(told["bundle"]),
        **{name: told[name] for name in ("results_digest", "study_digest", "bundle_id", "trials", "cached")},
        **{name: told[name] for name in ("partial", "sim_seconds", "wall_seconds", "claims")},
        # It is there only where a lock was held against it.
        drift=told.get("drift"),
        notes=ended.told,
        answer=told,
    )


def check(manifest: PathLike, *, set: Optional[Mapping[str, Any]] = None, allow: Sequence[PathLike] = ()) -> list[Fault]:
    """Returns every fault and warning of `manifest`; where none is an error, it can be run."""
    changed = [f"--set={path}={_value(value)}" for path, value in (set or {}).items()]
    changed += [f"--allow={_path(folder)}" for folder in allow]
    return _faults(changed, manifest)


def _faults(changed: Sequence[str], manifest: PathLike) -> list[Fault]:
    ended = call(["check", "--format=json", *changed, "--", _path(manifest)])
    if ended.answer is None:
        raise_for(ended.code, ended.told)
    return [Fault.of(fault) for fault in ended.answer["faults"]]


def _refuse(ended: Answer, changed: Sequence[str], manifest: PathLike) -> NoReturn:
    """Raises why there was no answer: for a manifest's faults with each of them."""
    if ended.code == 2 and Path(manifest).is_file():
        faults = _faults(changed, manifest)
        if any(fault.severity == "error" for fault in faults):
            raise ManifestError(ended.told, faults)
    raise_for(ended.code, ended.told)


def _value(value: Any) -> str:
    """Returns a value as one writes it in YAML."""
    return value if isinstance(value, str) else json.dumps(value)


def _path(path: PathLike) -> str:
    return str(Path(path))

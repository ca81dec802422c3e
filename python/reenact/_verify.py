"""``reenact verify``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Union

from reenact import _html
from reenact._bundle import PathLike
from reenact._call import call
from reenact._errors import Failed, raise_for
from reenact._progress import Wanted, listener
from reenact._run import _path


@dataclass(frozen=True)
class Finding:
    """Something that a check found."""

    level: int
    #: ``error``, ``obstacle`` (this program cannot judge), ``failure`` (of this program) or ``note``.
    severity: str
    #: The file, or place in it, that it is about.
    path: str
    expected: str
    found: str
    #: What to do.
    hint: str


@dataclass(frozen=True)
class Verification:
    """What a check found. It is true where the bundle is what it says, up to the level that was asked for."""

    #: ``holds``, ``broken``, ``not-replicated``, ``not-attested`` or ``unanswered``.
    verdict: str
    #: The level that was asked for.
    asked: int
    #: The highest level that holds with all below it; none where not even level 0 does.
    reached: Optional[int]
    findings: tuple[Finding, ...]
    #: ``passed``, ``failed`` or ``not judged``, by name of level.
    levels: Mapping[str, str]
    name: Optional[str]
    results_digest: Optional[str]
    bundle_id: Optional[str]
    #: The whole answer (``schemas/answers/verify.schema.json``): samples, replication, signatures.
    answer: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __bool__(self) -> bool:
        return self.verdict == "holds"

    def _repr_html_(self) -> str:
        levels = _html.table(("level", ""), list(self.levels.items()))
        rows = [(f.level, f.severity, f.path, f.expected, f.found, f.hint) for f in self.findings]
        head = ("level", "", "where", "expected", "found", "what to do")
        return f"<div><p>{self.verdict}</p>{levels}{_html.table(head, rows) if rows else ''}</div>"


def verify(
    bundle: PathLike,
    level: int = 3,
    *,
    sample: Optional[int] = None,
    sample_seed: Optional[int] = None,
    robustness: Union[None, int, str] = None,
    trust: Optional[PathLike] = None,
    signature: Optional[PathLike] = None,
    jobs: Optional[int] = None,
    progress: Wanted = None,
) -> Verification:
    """Climbs from "safe to open" (0) over "every trial again" (5) to "fresh seeds agree" (6), as far as `level`.

    `sample` and `sample_seed` draw the trials of level 4, `robustness` is how many rows of tables of other settings are run
    again, `trust` is a file of keys that must vouch for the bundle and `signature` one that is not in it. A "no" is an answer:
    `NotUnderstood` and `Failed` are raised where there is none.
    """
    options = {
        "sample": sample,
        "sample-seed": sample_seed,
        "robustness": robustness,
        "trust": trust and _path(trust),
        "signature": signature and _path(signature),
        "jobs": jobs,
    }
    words = ["verify", "--format=json", f"--level={level}"]
    words += [f"--{name}={value}" for name, value in options.items() if value is not None]
    ended = call([*words, "--", _path(bundle)], listener(progress))
    told = ended.answer
    if told is None:
        raise_for(ended.code, ended.told)
    if ended.code == 3:
        raise Failed(ended.told or "error: the program failed while it checked the bundle", told)
    return Verification(
        **{name: told[name] for name in ("verdict", "asked", "reached", "name", "results_digest", "bundle_id")},
        findings=tuple(Finding(**finding) for finding in told["findings"]),
        levels={level["name"]: level["state"] for level in told["levels"]},
        answer=told,
    )

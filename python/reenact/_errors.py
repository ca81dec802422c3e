"""What goes wrong, in the words of the command."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, NoReturn, Optional, Sequence


class Error(Exception):
    """Something was not done. The text is what the command ``reenact`` writes to stderr."""

    #: How the command ends.
    exit_code: int = 3


class BundleError(Error):
    """A bundle is not what it says, so nothing is read from it."""

    exit_code = 1


class NotUnderstood(Error):
    """The request was not understood: an option, a file that is not there, a trial that does not exist."""

    exit_code = 2


@dataclass(frozen=True)
class Fault:
    """One fault, or warning, of a manifest or of a file that it names."""

    severity: str
    message: str
    #: What was expected and found, at the place.
    label: str
    help: Optional[str]
    file: Optional[str]
    #: From 1.
    line: Optional[int]
    #: In characters, from 1.
    column: Optional[int]

    @classmethod
    def of(cls, told: Mapping[str, Any]) -> Fault:
        """Takes it from an answer of ``reenact check``."""
        return cls(**{name: told[name] for name in cls.__dataclass_fields__})


class ManifestError(NotUnderstood):
    """A manifest cannot be run; `faults` has every fault, with its place."""

    def __init__(self, text: str, faults: Sequence[Fault] = ()) -> None:
        super().__init__(text)
        self.faults = tuple(faults)


class Failed(Error):
    """The program failed: a full disk, a trial that panicked, a bug. `answer` is what it answered all the same, if anything."""

    exit_code = 3

    def __init__(self, text: str, answer: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__(text)
        self.answer = answer


def raise_for(code: int, text: str) -> NoReturn:
    """Raises what stands for a command that ended with `code` and wrote `text` to stderr."""
    kinds = {1: BundleError, 2: NotUnderstood}
    raise kinds.get(code, Failed)(text)

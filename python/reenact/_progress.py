"""How far a run is, for whoever wants to know."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, Callable, Optional, Union

from reenact._errors import NotUnderstood


@dataclass(frozen=True)
class Progress:
    """How far a run is."""

    #: The study, where more than one may run: a calibration runs before what it is for.
    name: Optional[str]
    trials: int
    #: Of them, those from the store included.
    done: int
    #: Those that the store had.
    cached: int
    #: Those in which the program failed.
    failed: int


#: What is to be done about progress: a bar where tqdm is there (``None``) or must be (``True``), nothing, or a call with each
#: piece of news.
Wanted = Union[None, bool, Callable[[Progress], None]]


class Bar:
    """A bar of tqdm's, one for each run."""

    def __init__(self, tqdm: Any, disable: Optional[bool]) -> None:
        self._tqdm = tqdm
        self._disable = disable
        self._bar: Any = None

    def __call__(self, progress: Progress) -> None:
        if self._bar is None or progress.done == 0:
            self.close()
            self._bar = self._tqdm(
                total=progress.trials, desc=progress.name, unit="trial", disable=self._disable, leave=False
            )
        self._bar.update(progress.done - self._bar.n)

    def close(self) -> None:
        """Takes the bar away."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def listener(wanted: Wanted) -> Optional[Callable[[Progress], None]]:
    """Returns what is to be called with progress."""
    if wanted is False:
        return None
    if callable(wanted):
        return wanted
    try:
        with warnings.catch_warnings():
            # In a notebook without widgets it draws its bar as text, and says so at length.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ModuleNotFoundError as missing:
        if wanted is None:
            return None
        raise NotUnderstood("a progress bar needs tqdm: pip install tqdm, or give a function as `progress`") from missing
    # Nobody watches a pipe: tqdm finds out where it is not told.
    return Bar(tqdm, disable=None if wanted is None else False)

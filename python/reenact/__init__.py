"""Re-enacts published robot-exploration experiments, exactly.

``run`` simulates a manifest and seals a bundle, ``verify`` checks one, ``Bundle`` reads one: its trials, curves, tables and
claims as data frames, its figures, and any trial again as arrays. The command ``reenact`` comes with the package.
"""

from reenact._bundle import Bundle, Figure, Figures, Tables
from reenact._errors import BundleError, Error, Failed, Fault, ManifestError, NotUnderstood
from reenact._progress import Progress
from reenact._reenact import __version__
from reenact._replay import Map, Replay, Scans
from reenact._run import Run, check, run
from reenact._verify import Finding, Verification, verify

__all__ = [
    "Bundle",
    "BundleError",
    "Error",
    "Failed",
    "Fault",
    "Figure",
    "Figures",
    "Finding",
    "ManifestError",
    "Map",
    "NotUnderstood",
    "Progress",
    "Replay",
    "Run",
    "Scans",
    "Tables",
    "Verification",
    "__version__",
    "check",
    "run",
    "verify",
]

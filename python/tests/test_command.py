"""The command that the package brings is the program."""

from __future__ import annotations

import signal
import subprocess
import sys
from importlib.metadata import distribution, version
from pathlib import Path

import reenact
from conftest import COMMAND, PUBLISHED, Command


def test_it_is_of_the_packages_version_and_ends_as_the_program_does(command: Command, place: Path) -> None:
    assert version("reenact") == reenact.__version__
    assert command("--version").stdout == f"reenact {reenact.__version__}\n"
    as_module = subprocess.run([sys.executable, "-m", "reenact", "--version"], capture_output=True, text=True)
    assert as_module.stdout == command("--version").stdout
    (place / "broken.zip").write_text("no zip")
    ends = [command("verify", str(PUBLISHED), "--level", "1"), command("verify", "broken.zip"), command("verify")]
    assert [end.returncode for end in ends] == [0, 1, 2]
    assert "reached level 1 (fixity)" in ends[0].stdout


def test_it_is_ended_by_the_signal_that_interrupts_it(tiny: str) -> None:
    study = Path(tiny)
    study.write_text(study.read_text().replace("trials: 2", "trials: 60"))
    process = subprocess.Popen([str(COMMAND), "run", tiny, "--jobs", "1"], stderr=subprocess.PIPE, text=True)
    store = Path("../home/.cache/reenact")
    while not any(file.stat().st_size for file in store.rglob("*") if file.is_file()):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, told = process.communicate()
    assert process.returncode == -signal.SIGINT and "of 120 trials of demo are kept" in told


def test_the_package_says_what_it_is() -> None:
    package = distribution("reenact").metadata
    assert package["License-Expression"] == "MIT OR Apache-2.0"
    assert package["Requires-Python"] == ">=3.9"
    needed = distribution("reenact").requires or []
    assert all("extra ==" in one for one in needed), "nothing is needed to run, verify and read"
    files = {str(file) for file in distribution("reenact").files or []}
    assert {"reenact/py.typed", "reenact/_reenact.pyi"} <= files

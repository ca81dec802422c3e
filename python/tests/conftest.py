"""A place of its own for every test: working directory, store and home are in it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Callable

import pytest

import reenact

REPOSITORY = Path(__file__).resolve().parents[2]
PUBLISHED = REPOSITORY / "artifacts" / "quickstart-published.zip"
#: The command that the package brings.
COMMAND = Path(sys.executable).parent / "reenact"

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working directory."""
    for name in ("REENACT_STORE", "XDG_CACHE_HOME", "SOURCE_DATE_EPOCH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    work = tmp_path / "work"
    for folder in (tmp_path / "home", work):
        folder.mkdir()
    monkeypatch.chdir(work)
    return work


@pytest.fixture
def command() -> Command:
    """Runs the command ``reenact``."""

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([str(COMMAND), *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)

    return run


@pytest.fixture
def tiny(command: Command) -> str:
    """The starter study, of two conditions of two trials of half a minute."""
    assert command("init", "demo").returncode == 0
    study = Path("demo/demo.yaml").read_text()
    short = study.replace("trials: 10", "trials: 2")
    assert short != study
    Path("demo/demo.yaml").write_text(short)
    return "demo/demo.yaml"


@pytest.fixture(scope="session")
def published() -> reenact.Bundle:
    """The quickstart's bundle that is kept in the repository, only held against its checksums: it may be of an older engine."""
    return reenact.Bundle(PUBLISHED, level=1)

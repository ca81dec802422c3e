"""``reenact.verify``: a "no" is an answer."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

import pytest

import reenact
from conftest import PUBLISHED, Command


def tampered(at: Path) -> Path:
    """Copies the published bundle with one number changed."""
    with zipfile.ZipFile(PUBLISHED) as whole, zipfile.ZipFile(at, "w") as changed:
        for name in whole.namelist():
            data = whole.read(name)
            if name.endswith("results/trials.csv"):
                data = data.replace(b"1", b"2", 1)
            changed.writestr(zipfile.ZipInfo(name), data)
    return at


def test_a_yes_has_every_level_and_no_finding(tiny: str, command: Command) -> None:
    bundle = reenact.run(tiny).path
    heard: list[reenact.Progress] = []
    answer = reenact.verify(bundle, 5, progress=heard.append)
    assert answer and (answer.verdict, answer.asked, answer.reached) == ("holds", 5, 5)
    assert answer.levels == dict.fromkeys(["safe", "fixity", "coherent", "derived", "sampled", "full"], "passed")
    assert (heard[0].trials, heard[-1].done) == (4, 4)
    told = json.loads(command("verify", str(bundle), "--format", "json").stdout)
    assert (answer.bundle_id, answer.results_digest) == (told["bundle_id"], told["results_digest"])
    html = answer._repr_html_()
    assert html.startswith("<div><p>holds</p><table>") and html.count("passed") == 6


def test_a_no_is_an_answer_with_findings(place: Path) -> None:
    answer = reenact.verify(tampered(place / "changed.zip"))
    assert not answer and (answer.verdict, answer.reached) == ("broken", 0)
    finding = answer.findings[0]
    assert (finding.level, finding.severity, finding.path) == (1, "error", "data/results/trials.csv")
    assert re.fullmatch("sha256:[0-9a-f]{64}, as manifest-sha256.txt says", finding.expected)
    assert re.fullmatch("sha256:[0-9a-f]{64}", finding.found)
    # What follows from the file is told, too.
    assert {later.level for later in answer.findings[1:]} == {2, 3}
    assert answer.levels["fixity"] == "failed"
    assert "data/results/trials.csv" in answer._repr_html_()


def test_no_answer_is_an_exception(command: Command) -> None:
    for words in (["none.zip"], ["none.zip", "--level", "9"]):
        level = int(words[-1]) if len(words) > 1 else 3
        with pytest.raises(reenact.NotUnderstood) as wrong:
            reenact.verify(words[0], level)
        asked = command("verify", *words)
        assert (str(wrong.value), 2) == (asked.stderr.strip(), asked.returncode)


def test_a_bundle_that_is_not_what_it_says_is_refused_in_the_commands_words(place: Path, command: Command) -> None:
    path = tampered(place / "changed.zip")
    with pytest.raises(reenact.BundleError) as refused:
        reenact.Bundle(path)
    asked = command("report", str(path))
    assert (str(refused.value), refused.value.exit_code) == (asked.stderr.strip(), asked.returncode)
    shown = reenact.Bundle(path, unchecked=True)
    assert not shown.holds and shown.checked.startswith("NOT WHAT IT SAYS: ")
    assert "<strong>NOT WHAT IT SAYS: " in shown._repr_html_()
    with pytest.raises(reenact.NotUnderstood) as deep:
        reenact.Bundle(path, level=5)
    assert str(deep.value) == "error: a bundle is opened at level 0 to 3, found 5; `verify` executes trials again"

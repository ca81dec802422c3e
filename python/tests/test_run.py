"""``reenact.run``: what it answers, what it raises, how far it tells that it is, and how it is interrupted."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import reenact
from conftest import Command


def test_a_run_answers_as_the_command_does(tiny: str, command: Command) -> None:
    heard: list[reenact.Progress] = []
    run = reenact.run(tiny, jobs=1, progress=heard.append)
    told = json.loads(command("run", tiny, "--format", "json").stdout)
    assert (run.trials, run.cached, run.partial, run.drift) == (4, 0, False, None)
    assert told["cached"] == 4, "the store is the same"
    for name in ("results_digest", "study_digest", "claims", "sim_seconds"):
        assert getattr(run, name) == told[name]
    assert run and run.claims and run.path.is_absolute() and run.path.parent == Path("artifacts").resolve()
    assert (heard[0], heard[-1]) == (reenact.Progress("demo", 4, 0, 0, 0), reenact.Progress("demo", 4, 4, 0, 0))
    assert [one.done for one in heard] == sorted(one.done for one in heard)
    assert run.bundle.results_digest == run.results_digest
    assert list(run.bundle.claims["claim"]) == list(run.claims)
    assert list(run.bundle.claims["verdict"]) == list(run.claims.values())
    html = run._repr_html_()
    for claim in run.claims:
        assert f"<td style=\"text-align:left\">{claim}</td>" in html


def test_a_part_of_a_study_is_partial_and_changes_are_taken(tiny: str) -> None:
    only = {"prior": ["none", "floor-plan"]}
    run = reenact.run(tiny, only=only, trials=1, set={"seed": 7, "title": "Another title"}, cache=False, progress=False)
    assert (run.trials, run.partial, run.claims) == (2, True, {})
    assert run.bundle.title == "Another title" and run.bundle.partial
    assert run.bundle.trial_names == ["none/0", "floor-plan/0"]


def test_a_request_that_is_not_understood_is_told_in_the_commands_words(tiny: str, command: Command) -> None:
    with pytest.raises(reenact.NotUnderstood) as wrong:
        reenact.run(tiny, only={"colour": "red"})
    assert type(wrong.value) is reenact.NotUnderstood
    asked = command("run", tiny, "--only", "colour=red")
    assert (str(wrong.value), wrong.value.exit_code) == (asked.stderr.strip(), asked.returncode)
    with pytest.raises(reenact.NotUnderstood, match=re.escape("error: cannot read `none.yaml`: no such file")):
        reenact.run("none.yaml")


def test_a_manifest_at_fault_is_told_whole_and_as_data(tiny: str, command: Command) -> None:
    study = Path(tiny)
    study.write_text(study.read_text().replace("trials: 2", "trails: 2"))
    with pytest.raises(reenact.ManifestError) as wrong:
        reenact.run(tiny)
    asked = command("run", tiny)
    assert (str(wrong.value), wrong.value.exit_code) == (asked.stderr.strip(), asked.returncode)
    unknown = next(fault for fault in wrong.value.faults if "trails" in fault.message)
    line = 1 + study.read_text().splitlines().index("trails: 2")
    assert (unknown.severity, unknown.file, unknown.line, unknown.column) == ("error", tiny, line, 1)
    assert reenact.check(tiny) == list(wrong.value.faults)


def test_what_is_kept_of_an_interrupted_run_is_found_again(tiny: str) -> None:
    study = Path(tiny)
    study.write_text(study.read_text().replace("trials: 2", "trials: 60"))
    script = (
        "import reenact, sys\n"
        "def tell(progress):\n"
        "    print(progress.done, flush=True)\n"
        "try:\n"
        "    reenact.run(sys.argv[1], jobs=1, progress=tell)\n"
        "except KeyboardInterrupt as interrupt:\n"
        "    print(interrupt, flush=True)\n"
        "    raise SystemExit(42)\n"
    )
    # A notebook's stop reaches one process only, Ctrl-C in a terminal all of its group.
    kept = 0
    for everyone in (False, True):
        started = [sys.executable, "-c", script, tiny]
        process = subprocess.Popen(started, stdout=subprocess.PIPE, text=True, start_new_session=True)
        assert process.stdout is not None
        # The second goes on where the first was, so that more is done.
        while int(process.stdout.readline()) < kept + 3:
            pass
        if everyone:
            os.killpg(process.pid, signal.SIGINT)
        else:
            process.send_signal(signal.SIGINT)
        began = time.monotonic()
        last = process.stdout.read().splitlines()[-1]
        assert process.wait() == 42 and time.monotonic() - began < 5
        told = re.fullmatch(
            r"interrupted: (\d+) of 120 trials of demo are kept; the same command goes on where it was", last
        )
        assert told and int(told[1]) >= kept + 3, last
        kept = int(told[1])
        assert not list(Path(".").rglob(".partial-*")), "nothing half written stays"
    heard: list[reenact.Progress] = []

    class Enough(Exception):
        pass

    def stop(progress: reenact.Progress) -> None:
        heard.append(progress)
        raise Enough

    # What a function raises ends the run, too.
    with pytest.raises(Enough):
        reenact.run(tiny, progress=stop)
    assert heard[0].cached >= kept


def test_a_bar_is_drawn_by_tqdm_or_asked_for_in_vain(
    tiny: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    reenact.run(tiny, progress=True)
    drawn = capfd.readouterr().err
    assert "demo:   0%|" in drawn and "| 0/4 [" in drawn
    reenact.run(tiny)
    assert capfd.readouterr().err == "", "nobody watches a pipe"
    for module in ("tqdm", "tqdm.auto"):
        monkeypatch.setitem(sys.modules, module, None)
    assert reenact.run(tiny).cached == 4
    with pytest.raises(reenact.NotUnderstood) as missing:
        reenact.run(tiny, progress=True)
    assert str(missing.value) == "a progress bar needs tqdm: pip install tqdm, or give a function as `progress`"

"""Calls of the command in a process of its own, which an interrupt ends at once and with everything finished kept."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Callable, Mapping, Optional, Sequence

from reenact._errors import Failed
from reenact._progress import Bar, Progress

#: Isolated from what lies in the folder where it is started; the first word says where this package is.
_START = "import sys; sys.path.insert(0, sys.argv.pop(1)); from reenact._command import main; main()"
_PROGRESS = '{"progress":'
#: How long an interrupted process may take to tidy up (s): it removes what is half written, which is little.
_PATIENCE_S = 10.0


@dataclass(frozen=True)
class Answer:
    """What a command answered."""

    code: int
    #: The line of ``--format json``; none where it did not get as far.
    answer: Optional[Mapping[str, Any]]
    #: What it wrote to stderr, progress left out.
    told: str


def call(words: Sequence[str], listener: Optional[Callable[[Progress], None]] = None) -> Answer:
    """Runs ``reenact`` with `words`, of which one asks for JSON."""
    if not sys.executable:
        raise Failed("error: cannot tell where Python is: sys.executable is empty, so no process can be started")
    package = str(Path(__file__).resolve().parent.parent)
    process = subprocess.Popen(
        [sys.executable, "-I", "-S", "-c", _START, package, *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "REENACT_PROGRESS": "json"},
    )
    out: list[bytes] = []
    told: list[str] = []
    assert process.stderr is not None
    results = threading.Thread(target=lambda: out.extend(process.stdout or ()), daemon=True)
    # An interrupt reaches whoever waits for a queue at once, and loses none of its lines.
    lines: queue.SimpleQueue[Optional[bytes]] = queue.SimpleQueue()
    notes = threading.Thread(target=_queue, args=(process.stderr, lines), daemon=True)
    results.start()
    notes.start()
    try:
        while (line := lines.get()) is not None:
            _hear(line, told, listener)
        results.join()
        code = process.wait()
    except KeyboardInterrupt:
        _end(process)
        while (line := lines.get()) is not None:
            _hear(line, told, None)
        raise KeyboardInterrupt(_text(told)) from None
    except BaseException:
        _end(process)
        raise
    finally:
        if isinstance(listener, Bar):
            listener.close()
    if code == -signal.SIGINT:
        raise KeyboardInterrupt(_text(told))
    if code < 0:
        raise Failed(f"{_text(told)}\nerror: the process was ended by signal {-code}".strip())
    first = next((line for line in out if line.strip()), None)
    return Answer(code, None if first is None else json.loads(first), _text(told))


def _queue(stream: IO[bytes], lines: queue.SimpleQueue[Optional[bytes]]) -> None:
    try:
        for line in stream:
            lines.put(line)
    finally:
        lines.put(None)


def _hear(line: bytes, told: list[str], listener: Optional[Callable[[Progress], None]]) -> None:
    text = line.decode("utf-8", "replace")
    if not text.startswith(_PROGRESS):
        told.append(text)
    elif listener is not None:
        listener(Progress(**json.loads(text)["progress"]))


def _text(told: Sequence[str]) -> str:
    return "".join(told).strip()


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends it as Ctrl-C does: a terminal has told it already, a notebook has not."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

"""Watches `reenact run` in a pseudo-terminal, as a person sees it: nothing wraps, nothing of the bar remains, an interrupt leaves
the terminal as it was, NO_COLOR is followed.

    python3 .ci/terminal.py REENACT MANIFEST [ARGUMENT...]

Nothing but the standard library of Python on a Unix. Exit code 0 where all of it holds.
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import sys
import termios
import time

COLOR = re.compile(r"\x1b\[[0-9;]*m")


def watch(command, columns, environment, interrupt_at=None):
    """What the process wrote to a terminal of so many columns, and how it ended."""
    pid, master = pty.fork()
    size = struct.pack("HHHH", 24, columns, 0, 0)
    if pid == 0:
        fcntl.ioctl(0, termios.TIOCSWINSZ, size)
        os.execvpe(command[0], command, environment)
    before = termios.tcgetattr(master)
    written, interrupted, began = b"", False, time.monotonic()
    while time.monotonic() - began < 600:
        ready, _, _ = select.select([master], [], [], 0.1)
        if ready:
            try:
                some = os.read(master, 65536)
            except OSError:
                break
            if not some:
                break
            written += some
        if interrupt_at and not interrupted and interrupt_at in written:
            interrupted = True
            os.write(master, b"\x03")
    after = termios.tcgetattr(master)
    assert before == after, "the terminal's settings have changed"
    _, status = os.waitpid(pid, 0)
    return written.decode("utf-8"), status


class Screen:
    """As much of a terminal as a bar uses: lines that end where the terminal ends, carriage returns, erasing."""

    def __init__(self, columns):
        self.columns, self.lines, self.x, self.y, self.wraps = columns, [""], 0, 0, []
        # The row on which the line under way began.
        self.began = 0

    def write(self, text):
        for token in re.findall(r"\x1b\[[0-9;?]*[A-Za-z]|.", text, re.S):
            self.token(token)

    def token(self, token):
        if token == "\r":
            self.x = 0
        elif token == "\n":
            self.y += 1
            self.began = self.y
            if self.y == len(self.lines):
                self.lines.append("")
        elif token.startswith("\x1b["):
            count = int(re.search(r"\d+", token).group()) if re.search(r"\d+", token) else 1
            line = self.lines[self.y]
            if token.endswith("K"):
                self.lines[self.y] = "" if "2" in token else line[: self.x]
            elif token.endswith("A"):
                self.y = max(0, self.y - count)
            elif token.endswith("B"):
                self.y = min(len(self.lines) - 1, self.y + count)
            elif token.endswith("G"):
                self.x = count - 1
            else:
                assert token.endswith("m") or token in ("\x1b[J", "\x1b[0J"), f"unexpected {token!r}"
        else:
            if self.x >= self.columns:
                self.wraps.append(self.lines[self.began])
                self.x = 0
                self.y += 1
                if self.y == len(self.lines):
                    self.lines.append("")
            line = self.lines[self.y].ljust(self.x)
            self.lines[self.y] = line[: self.x] + token + line[self.x + 1 :]
            self.x += 1


def seen(written, columns):
    screen = Screen(columns)
    screen.write(written)
    return screen


def main():
    command = sys.argv[1:2] + ["run"] + sys.argv[2:]
    base = {**os.environ, "TERM": "xterm-256color", "LANG": "C.UTF-8"}
    base.pop("NO_COLOR", None)
    for columns in (80, 40):
        written, status = watch(command, columns, base)
        assert os.waitstatus_to_exitcode(status) == 0, written
        assert COLOR.search(written), "a terminal has colours"
        assert "real time" in written or columns < 80, "the bar tells the rate"
        screen = seen(written, columns)
        # Addresses of bundles and digests cannot be folded, nor a command that somebody is to copy.
        is_whole = lambda line: "sha256:" in line or line.startswith("/") or re.match(r"(next:| {5}) reenact ", line)
        wraps = [line for line in screen.wraps if not is_whole(line)]
        assert not wraps, f"wraps at {columns} columns: {wraps[:3]}"
        left = [line for line in screen.lines if "━" in line or " left" in line or "real time" in line]
        assert not left, f"left of the bar: {left}"
        assert re.search(r"\d+ trials?: ", "\n".join(screen.lines)), "the summary is there"
        print(f"pass  {columns} columns")
    plain, _ = watch(command, 80, {**base, "NO_COLOR": "1"})
    assert not COLOR.search(plain), "NO_COLOR is set"
    ascii_bar, _ = watch(command, 80, {**base, "LANG": "C", "LC_ALL": "C"})
    assert "━" not in ascii_bar and "=>" in ascii_bar, "a bar in ASCII where the locale is no UTF-8"
    print("pass  NO_COLOR, and a bar in ASCII")
    written, status = watch(command, 80, base, interrupt_at=b" 1/")
    assert os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGINT, status
    assert "\x1b[?25l" not in written or "\x1b[?25h" in written, "the cursor is hidden"
    print("pass  an interrupt")


main()

"""The command ``reenact``: the same program as the binary of a release, in the process of the interpreter."""

import signal
import sys

from reenact import _reenact


def main() -> None:
    """Runs the command line and ends as it ends."""
    # The program has its own way to end where it is interrupted; Python's would wait until everything is done.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_reenact.main(sys.argv[0], sys.argv[1:]))


if __name__ == "__main__":
    main()

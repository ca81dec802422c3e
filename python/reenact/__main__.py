"""``python -m reenact`` is the command ``reenact``."""

from reenact._command import main

main()

"""The program ``hpf``."""

from __future__ import annotations

import sys

from hpf._hpf import _main


def main() -> int:
    """Runs the program with the arguments of the command line; returns its exit code."""
    return _main(["hpf", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())

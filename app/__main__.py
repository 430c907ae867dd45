"""The command `ratslam`, also `python -m app`. Imports take a second, so they run inside `command`: it handles Ctrl+C."""

from __future__ import annotations

import sys

from app.startup.ending import command


def main() -> int:
    return command(_command)


def _command() -> int:
    from app.cli.command_line import main

    try:
        return main()
    except SystemExit as leave:  # argparse has said what there is to say
        return leave.code if isinstance(leave.code, int) else 1


if __name__ == "__main__":
    sys.exit(main())

"""Where the report of a run goes."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from disk import write_whole


def write_report(report: dict[str, Any], file: Path | None, words: str) -> None:
    """Write the report to a file and say so in words, or without a file print it. OSError: it was printed instead."""
    text = json.dumps(report, indent=2) + "\n"
    if file is None:
        print(text, end="")
        if report.get("partial"):
            print(words, file=sys.stderr)
        return
    try:
        write_whole(file, text)
    except OSError:
        print(text, end="")  # the run is over: its report is not lost for want of a file
        raise
    print(f"{words}; report in {file}")

"""Where a run saves its brain."""

from __future__ import annotations

import sys
from pathlib import Path

from disk import encode
from ratslam_core import RatSlam, save_brain


class BrainFile:
    """Where the brain is saved at the end. It is saved after the report, so that a failure does not lose the report."""

    def __init__(self, path: Path) -> None:
        self._path, self._warned = path, False
        self._brain: RatSlam | None = None

    def look(self, brain: RatSlam) -> None:
        """Remember the brain, and warn once if it is becoming too large for a file. Called from time to time."""
        self._brain = brain
        warning = None if self._warned else encode(brain).outgrowing
        if warning is not None:
            self._warned = True
            print(f"ratslam: note: {warning}", file=sys.stderr)

    def save(self) -> None:
        """Save the brain that was passed to `look` last. OSError, ValueError: it cannot be saved."""
        if self._brain is not None:
            save_brain(self._brain, self._path)

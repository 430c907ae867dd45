"""The recording that is played. Part of a snapshot."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RecordingView:
    """What the page tells of it."""

    name: str
    format: str  # "Donkey tub", "MCAP", ...
    moments: int
    seconds: float
    has: tuple[str, ...]  # "camera", "speed", "truth", ...
    over: bool  # its last moment has been played

"""Tick: one tick stage by stage, and what the parts of a tick cost."""

from __future__ import annotations

from web.messages import Parameter, TickWalk, Timing
from web.panel.part import Content

RATE = "robot.sensor_rate_hz"  # ticks a second


def walk(walk: TickWalk | None) -> Content:
    """The stages; those to come have no words yet."""
    if walk is None:
        return Content({"at": None, "stages": []})
    stages = [(stage.title, stage.words if k <= walk.at else "") for k, stage in enumerate(walk.stages)]
    return Content({"at": walk.at, "stages": stages})


def timings(timings: tuple[Timing, ...], parameters: tuple[Parameter, ...]) -> Content:
    """Milliseconds of each part over the last hundred ticks, and how many a tick may take at x1."""
    rate_hz = next((float(p.value) for p in parameters if p.name == RATE), 10.0)
    parts = [(timing.part, round(timing.mean_ms, 3), round(timing.worst_ms, 2)) for timing in timings]
    return Content({"there_are_ms": 1000 / rate_hz, "parts": parts})

"""Rows that need no simulated robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks import engine
from benchmarks.true_map.figures import Figure, at_most

MOST_MS = 1.0


def _step(_data: Path) -> Iterator[Figure]:
    row = engine.whole_step(50_000, MOST_MS)
    yield at_most("RatSlam.step at 50,000", row["ms"], MOST_MS, "ms")


ROWS: dict[str, tuple[str, Callable[[Path], Iterator[Figure]]]] = {
    "step": ("RatSlam.step with 50,000 views and experiences; about half a minute", _step),
}

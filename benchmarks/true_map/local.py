"""Rows that need no simulated robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks import engine
from benchmarks.back_end.rows import BAR_LIES, BAR_M, BAR_S, graphs, rows
from benchmarks.true_map.figures import Figure, at_most

MOST_MS = 1.0
CLAIMED_M = 0.15


def _step(_data: Path) -> Iterator[Figure]:
    row = engine.whole_step(50_000, MOST_MS)
    yield at_most("RatSlam.step at 50,000", row["ms"], MOST_MS, "ms")


def _back_end(data: Path) -> Iterator[Figure]:
    """Each graph twice: claiming what is true, and what the files of others claim."""
    for graph in graphs(data):
        for claimed, words in ((graph, "true claims"), (graph.claiming(CLAIMED_M), f"claiming {CLAIMED_M:g} m")):
            for row in rows(claimed, (BAR_LIES,)):
                if row["lies"]:
                    yield at_most(f"{graph.name}, {words}: off", row["to_clean_m"], BAR_M)
                    yield at_most(f"{graph.name}, {words}: time", row["seconds"], BAR_S, "s")


ROWS: dict[str, tuple[str, Callable[[Path], Iterator[Figure]]]] = {
    "back-end": (f"{BAR_LIES} false closures in graphs; about a minute", _back_end),
    "step": ("RatSlam.step with 50,000 views and experiences; about half a minute", _step),
}

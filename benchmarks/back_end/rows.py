"""The rows: each graph with more and more false closures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from app.evaluation import rmse
from benchmarks.back_end.cities import manhattan, ring_city
from benchmarks.back_end.files import g2o_files, intel, read_g2o
from benchmarks.back_end.graph import Graph, Rows, lied_to
from benchmarks.back_end.solving import Solved, solve

DATA = Path(__file__).parents[3] / "shared" / "data"
LIES = (10, 50, 200, 500, 1000)
BAR_LIES, BAR_M, BAR_S = 200, 0.1, 0.5
Row = dict[str, Any]


def graphs(data: Path = DATA, given: list[Path] | None = None) -> Iterator[Graph]:
    """All graphs. ValueError for a file that cannot be read."""
    yield manhattan()
    yield ring_city()
    lab = intel(data)
    if lab is None:
        print(f"Intel: skipped, there is no logs/intel/intel.relations in {data}; give its folder with --data")
    else:
        yield lab
    for file in g2o_files(data, given or []):
        yield read_g2o(file)


def rows(graph: Graph, lies: tuple[int, ...] = LIES, seed: int = 1) -> Iterator[Row]:
    """A row for the graph as it is, and one for each number of false closures. Same seed, same lies.

    The clean solution is that of the graph as it is by an optimiser that doubts nothing.
    """
    clean = solve(graph, doubting=False).poses
    solve(graph)  # so that nothing is compiled while the clock runs
    yield _row(graph, 0, clean, solve(graph))
    for count in lies:
        yield _row(graph, count, clean, solve(lied_to(graph, clean, count, np.random.default_rng([seed, count]))))


def _row(graph: Graph, lies: int, clean: Rows, solved: Solved) -> Row:
    to_clean = rmse(solved.poses[:, :2], clean[:, :2])
    truth = None if graph.truth is None else graph.truth[:, :2]
    judged = lies == BAR_LIES
    return {
        "graph": graph.name, "places": len(graph), "closures": len(graph.ends), "lies": lies,
        "to_clean_m": round(to_clean, 4), "seconds": round(solved.seconds, 3), "calls": solved.calls,
        "to_truth_m": None if truth is None else round(rmse(solved.poses[:, :2], truth), 4),
        "clean_to_truth_m": None if truth is None else round(rmse(clean[:, :2], truth), 4),
        "holds": to_clean <= BAR_M and solved.seconds <= BAR_S if judged else None,
    }  # fmt: skip


def line(row: Row) -> str:
    """A row in words."""
    truth = (
        ""
        if row["to_truth_m"] is None
        else f"to the truth {row['to_truth_m']:.2f} m (clean {row['clean_to_truth_m']:.2f})"
    )
    verdict = "" if row["holds"] is None else f"bar {BAR_M:g} m, {BAR_S:g} s: {'holds' if row['holds'] else 'MISSED'}"
    size = f"{row['places']:,} places, {row['closures']:,} closures"
    return (
        f"{row['graph']:10} {size:30} {row['lies']:5} false: {row['to_clean_m']:6.2f} m off the clean one, "
        f"{row['seconds']:6.2f} s in {row['calls']:3} calls; {truth:35} {verdict}"
    ).rstrip()

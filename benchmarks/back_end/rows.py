"""The rows: each graph with more and more false closures."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from app.evaluation import rmse
from benchmarks.back_end.cities import manhattan, ring_city
from benchmarks.back_end.files import g2o_files, intel, read_g2o
from benchmarks.back_end.graph import Graph, lied_to
from benchmarks.back_end.solving import solve

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
    """A row for the clean graph, and one for each number of false closures. Same seed, same lies."""
    clean, seconds = solve(graph)
    yield _row(graph, 0, clean, clean, seconds)
    for count in lies:
        found, seconds = solve(lied_to(graph, clean, count, np.random.default_rng([seed, count])))
        yield _row(graph, count, found, clean, seconds)


def _row(graph: Graph, lies: int, found: np.ndarray, clean: np.ndarray, seconds: float) -> Row:
    to_clean = rmse(found[:, :2], clean[:, :2])
    to_truth = None if graph.truth is None else rmse(found[:, :2], graph.truth[:, :2])
    judged = lies == BAR_LIES
    return {
        "graph": graph.name, "places": len(graph), "closures": len(graph.ends), "lies": lies,
        "to_clean_m": round(to_clean, 4), "to_truth_m": None if to_truth is None else round(to_truth, 4),
        "seconds": round(seconds, 3), "holds": to_clean <= BAR_M and seconds <= BAR_S if judged else None,
    }  # fmt: skip


def line(row: Row) -> str:
    truth = "" if row["to_truth_m"] is None else f"{row['to_truth_m']:7.2f} m to the truth"
    verdict = "" if row["holds"] is None else f"bar {BAR_M:g} m, {BAR_S:g} s: {'holds' if row['holds'] else 'MISSED'}"
    size = f"{row['places']:,} places, {row['closures']:,} closures"
    return (
        f"{row['graph']:12} {size:32} {row['lies']:5} false {row['to_clean_m']:8.2f} m to the clean one "
        f"{row['seconds']:7.2f} s {truth:22} {verdict}"
    ).rstrip()

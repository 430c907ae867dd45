"""Graphs and lies of the back end's benchmark, and that the map's own optimiser is asked."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation import rmse
from benchmarks.back_end import __main__ as command
from benchmarks.back_end import rows as rows_of
from benchmarks.back_end.cities import manhattan, ring_city
from benchmarks.back_end.files import g2o_files, intel, read_g2o
from benchmarks.back_end.graph import Graph, between, compose, lied_to, measured
from benchmarks.back_end.rows import line, rows
from benchmarks.back_end.solving import solve


def test_a_city_is_driven_metre_by_metre_and_closed_where_it_was_before() -> None:
    for city in (manhattan, ring_city):
        graph, again = city(600), city(600)
        assert graph.truth is not None
        assert len(graph) == len(graph.truth) == 600
        assert np.hypot(*np.diff(graph.truth[:, :2], axis=0).T) == pytest.approx(np.ones(599))
        i, j = graph.ends.T
        assert len(i) > 20
        assert (j - i > 20).all()
        assert graph.truth[i, :2] == pytest.approx(graph.truth[j, :2])
        off = between(between(graph.truth[i], graph.truth[j]), graph.moves)
        assert np.abs(off).max() < 0.15
        assert np.array_equal(graph.moves, again.moves)
        assert np.array_equal(graph.backbone, again.backbone)


@given(st.integers(1, 300), st.integers(0, 1000))
def test_lies_are_false_and_claim_to_be_precise(count: int, seed: int) -> None:
    graph = manhattan(400)
    assert graph.truth is not None
    lied = lied_to(graph, graph.truth, count, np.random.default_rng(seed))
    known = len(graph.ends)
    i, j = lied.ends[known:].T
    assert len(i) == count
    assert (np.hypot(*(graph.truth[i, :2] - graph.truth[j, :2]).T) > 2.0).all()
    assert np.hypot(*lied.moves[known:, :2].T).max() < 1.0
    assert np.array_equal(lied.moves[:known], graph.moves)
    assert set(lied.sigma) == set(graph.sigma)


def square(laps: int = 3) -> Graph:
    """Laps round a square of 10 m, a metre at a time."""
    corner, truth, start = np.array([10.0, 0.0, math.pi / 2]), [], np.zeros(3)
    for _ in range(4 * laps):
        truth += [compose(start, np.array([k, 0.0, 0.0])) for k in range(10)]
        start = compose(start, corner)
    ends = np.array([(k, k + 40) for k in range(40 * (laps - 1))], np.int64)
    return measured("square", np.array(truth), ends, np.random.default_rng(1))


def test_the_clean_graph_is_solved_better_than_odometry_whatever_precision_it_claims() -> None:
    graph = square()
    assert graph.truth is not None
    found, calls, seconds = solve(graph)
    assert rmse(found[:, :2], graph.truth[:, :2]) < 0.5 * rmse(graph.odometry[:, :2], graph.truth[:, :2])
    assert 1 <= calls < 100
    assert seconds > 0
    assert np.array_equal(found, solve(graph).poses)
    plainly = solve(graph, doubting=False).poses
    assert plainly == pytest.approx(found, abs=0.2)
    claimed = graph.claiming(0.15)
    assert set(claimed.sigma) == set(claimed.backbone_sigma) == {0.15}
    assert np.array_equal(claimed.moves, graph.moves)
    assert solve(claimed, doubting=False).poses == pytest.approx(plainly, abs=1e-6)


def test_the_rows_say_how_far_off_lies_take_it() -> None:
    told = list(rows(square(), (5, 200)))
    assert [row["lies"] for row in told] == [0, 5, 200]
    assert told[0]["to_clean_m"] < 0.05
    assert told[0]["clean_to_truth_m"] < 0.5
    assert [row["holds"] is None for row in told] == [True, True, False]
    assert told[1]["closures"] == told[0]["closures"] == 80  # the true ones
    assert "200 false" in line(told[2])
    assert "bar 0.1 m, 0.5 s: " in line(told[2])


G2O = """VERTEX_SE2 3 0 0 0
VERTEX_SE2 5 1 0 0
VERTEX_SE2 9 2 0 1.5
EDGE_SE2 3 5 1.1 0.1 0.2 100 0 0 100 0 50
EDGE_SE2 3 9 2.2 0.0 1.4 25 0 0 25 0 50
# a note
"""


def test_a_g2o_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "small.g2o"
    file.write_text(G2O, encoding="ascii")
    graph = read_g2o(file)
    assert (graph.name, len(graph)) == ("small", 3)
    assert graph.backbone[0] == pytest.approx([1.1, 0.1, 0.2])
    assert graph.backbone_sigma == pytest.approx([0.1, math.inf])
    assert graph.backbone[1] == pytest.approx([1.0, 0.0, 1.5])  # the gap: as the vertices lie
    assert graph.ends.tolist() == [[0, 2]]
    assert graph.sigma == pytest.approx([0.2])
    found = solve(graph).poses
    assert found[2] == pytest.approx([2.2, 0.0, 1.4], abs=1e-3)
    assert list(g2o_files(tmp_path, [Path("mine.g2o")])) == [Path("mine.g2o"), file]
    assert list(g2o_files(tmp_path / "none", [])) == []


def test_a_bad_g2o_file_is_named(tmp_path: Path) -> None:
    file = tmp_path / "bad.g2o"
    two = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\n"
    for text, sentence in (
        ("VERTEX_SE2 0 0 0\n", "line 1: "),
        (two.replace("1 0 0 0", "1 0 0 x"), "line 2: could not convert"),
        (two, "2 vertices and 0 edges"),
        (f"{two}EDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\n", "line 3: float division by zero"),
    ):
        file.write_text(text, encoding="ascii")
        with pytest.raises(ValueError, match=r"bad\.g2o: " + sentence):
            read_g2o(file)


def test_relations_become_a_graph(tmp_path: Path) -> None:
    folder = tmp_path / "logs" / "intel"
    assert intel(tmp_path) is None
    folder.mkdir(parents=True)
    way = [(10.0, 11.0, 1.0), (11.0, 12.5, 0.5), (12.5, 14.0, 2.0), (10.0, 14.0, 3.5)]
    text = "\n".join(f"{a} {b} {x} 0 0 0 0 0" for a, b, x in way)
    (folder / "intel.relations").write_text(text, encoding="ascii")
    graph = intel(tmp_path)
    assert graph is not None
    assert graph.truth is not None
    assert graph.truth[:, 0] == pytest.approx([0.0, 1.0, 1.5, 3.5])
    assert graph.ends.tolist() == [[0, 3]]
    assert all(b > a for a, b in pairwise(graph.odometry[:, 0]))


def test_the_command_prints_and_writes_its_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(rows_of, "manhattan", lambda: manhattan(120))
    monkeypatch.setattr(rows_of, "ring_city", lambda: ring_city(120))
    file, report = tmp_path / "small.g2o", tmp_path / "rows.json"
    file.write_text(G2O, encoding="ascii")
    assert command.main(["--data", str(tmp_path), "--lies", "3", "--report", str(report)]) == 0
    out = capsys.readouterr().out
    assert "Intel: skipped, there is no logs/intel/intel.relations in" in out
    assert [row["graph"] for row in json.loads(report.read_text("utf-8"))] == [
        name for name in ("Manhattan", "ring city", "small") for _ in range(2)
    ]
    file.write_text("EDGE_SE2 0\n", encoding="ascii")
    assert command.main(["--data", str(tmp_path), "--lies", "3"]) == 2
    for wrong in (["--lies", "0"], ["--claims", "0"], ["--report", "/nowhere/at/all.json"]):
        with pytest.raises(SystemExit):
            command.main(wrong)

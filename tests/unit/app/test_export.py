"""A run in the formats of other programs, read back by programs that are not ours."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import cv2
import networkx as nx
import numpy as np
import pytest
from graphslam.graph import Graph

from app.export import FORMATS, Choices, Window, check_export, export_run
from app.export.pose_graph import g2o_text
from app.session import Session

from .exported import AgainAndAgain, silent
from .sessions import a_session

pytestmark = pytest.mark.slow

TICKS = 400
BIN = Path(sys.executable).parent


@pytest.fixture(scope="module")
def run() -> AgainAndAgain:
    return AgainAndAgain(TICKS, orders={150: lambda s: s.set_mode("explore"), 250: lambda s: s.kidnap()})


@pytest.fixture(scope="module")
def at_the_end(run: AgainAndAgain) -> Session:
    *_, session = run.play()
    return session


def program(*words: object, folder: Path) -> str:
    """What a program says. Its settings go to a folder of the test's own."""
    own = os.environ | {"HOME": str(folder), "MPLBACKEND": "Agg"}
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120, env=own)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def rmse_of(said: str) -> float:
    return float(next(line.split()[1] for line in said.splitlines() if line.split()[:1] == ["rmse"]))


def test_the_map_as_a_pose_graph_is_the_map(run: AgainAndAgain, at_the_end: Session, tmp_path: Path) -> None:
    (file,) = export_run(run, "g2o", tmp_path / "run.g2o", Window(), silent)
    graph, map_ = Graph.from_g2o(str(file)), at_the_end.brain.experience_map
    poses = np.array([vertex.pose.to_array() for vertex in graph._vertices])
    np.testing.assert_array_equal(poses[:, :2], map_.poses[:, :2])
    np.testing.assert_allclose(np.exp(1j * poses[:, 2]), np.exp(1j * map_.poses[:, 2]), atol=1e-12)
    rows = np.flatnonzero(map_.transitions.believed[: map_.transitions.count] > 0)
    assert len(graph._edges) == len(rows) > 0
    for edge, row in zip(graph._edges, rows, strict=True):
        assert edge.vertex_ids == map_.transitions.ends[row].tolist()
        np.testing.assert_array_equal(edge.estimate.to_array()[:2], map_.transitions.move[row, :2])
        np.testing.assert_array_equal(edge.information, np.eye(3) * map_.transitions.believed[row])


def test_the_map_as_a_graph_has_its_ways_and_times(run: AgainAndAgain, at_the_end: Session, tmp_path: Path) -> None:
    (file,) = export_run(run, "graphml", tmp_path / "run.graphml", Window(), silent)
    graph, map_ = nx.read_graphml(file, node_type=int), at_the_end.brain.experience_map
    assert graph.is_directed()
    for i, (x, y, heading) in enumerate(map_.poses.tolist()):
        node = graph.nodes[i]
        assert (node["x"], node["y"], node["heading_rad"], node["view"]) == (x, y, heading, map_.views[i])
    assert set(graph.edges) == set(map(tuple, map_.links.tolist()))
    times = [graph.edges[i, j]["time_s"] for i, j in map_.links.tolist()]
    np.testing.assert_array_equal(times, map_.link_times)
    assert graph.edges[0, 1]["distance_m"] == map_.link(0, 1).distance_m
    goal = map_.active  # and networkx finds the quickest ways that the temporal map finds
    quickest = nx.single_source_dijkstra_path_length(graph.to_undirected(), goal, weight="time_s")
    for i, seconds in enumerate(map_.temporal_map.times_to(goal)):
        assert quickest.get(i, np.inf) == pytest.approx(seconds, rel=1e-9) or graph.has_edge(i, i)


def test_the_paths_are_those_that_evo_judges(run: AgainAndAgain, at_the_end: Session, tmp_path: Path) -> None:
    truth, estimate, believed = export_run(run, "tum", tmp_path / "run.tum", Window(), silent)
    assert [file.name for file in (truth, estimate, believed)] == [
        "run-truth.tum", "run-estimate.tum", "run-believed.tum"
    ]  # fmt: skip
    for file in (truth, estimate, believed):
        assert np.loadtxt(file).shape == (TICKS + 1, 8)
    said = program(BIN / "evo_ape", "tum", truth, estimate, "-a", folder=tmp_path)
    ours, _ = at_the_end.evaluation.errors(at_the_end.brain.experience_map)
    assert rmse_of(said) == pytest.approx(ours, abs=1e-5)


def test_the_table_has_a_row_for_each_tick(run: AgainAndAgain, at_the_end: Session, tmp_path: Path) -> None:
    (file,) = export_run(run, "csv", tmp_path / "run.csv", Window(), silent)
    with file.open(encoding="utf-8", newline="") as text:
        rows = list(csv.DictReader(text))
    assert [int(row["tick"]) for row in rows] == list(range(TICKS + 1))
    for session, row in zip(run.play(20), rows, strict=False):
        robot = session.estimate.pose_map_robot
        assert (float(row["x"]), float(row["y"]), float(row["heading_rad"])) == (robot.x, robot.y, robot.heading_rad)
        assert (float(row["speed"]), float(row["yaw_rate"])) == (session.odometry.speed, session.odometry.yaw_rate)
        assert int(row["experience"]) == session.brain.experience_map.active
    assert int(rows[-1]["experience"]) == at_the_end.brain.experience_map.active


def test_a_stretch_of_a_run(run: AgainAndAgain, tmp_path: Path) -> None:
    (file,) = export_run(run, "csv", tmp_path / "run.csv", Window(10.0, 12.5), silent)
    times = np.loadtxt(file, delimiter=",", skiprows=1, usecols=1)
    np.testing.assert_allclose(times, np.arange(100, 126) / 10)
    (early,) = export_run(run, "g2o", tmp_path / "early.g2o", Window(until_s=5.0), silent)
    assert early.read_bytes() == g2o_text(a_session(50))
    with pytest.raises(ValueError, match=r"the run is 40 s long, so there is nothing in it from 50 s on"):
        export_run(run, "csv", tmp_path / "late.csv", Window(50.0), silent)
    assert not (tmp_path / "late.csv").exists()
    for wrong in ((-1.0, 5.0), (float("nan"), 5.0), (5.0, 4.0), (0.0, float("nan"))):
        with pytest.raises(ValueError, match=r"--from|--until"):
            Window(*wrong)


def test_pictures_and_a_film(tmp_path: Path) -> None:
    short = AgainAndAgain(100)
    pictures = export_run(short, "png", tmp_path / "run.png", Window(), silent)
    assert [file.name for file in pictures] == ["run-map.png", "run-times.png", "run-paths.png"]
    for file in pictures:
        shown = cv2.imread(str(file))
        assert shown is not None
        assert shown.std() > 5
    (file,) = export_run(short, "mp4", tmp_path / "run.mp4", Window(), silent, Choices(speed=10.0))
    film = cv2.VideoCapture(str(file))
    assert (film.get(cv2.CAP_PROP_FRAME_COUNT), film.get(cv2.CAP_PROP_FPS)) == (21, 20)
    there, first = film.read()
    assert there
    assert first.std() > 5
    with pytest.raises(ValueError, match=r"--speed must be from 0.1 to 1000 times, got 0"):
        export_run(short, "mp4", tmp_path / "no.mp4", Window(), silent, Choices(speed=0.0))
    assert not (tmp_path / "no.mp4").exists()


@pytest.mark.parametrize("to", ["mcap", "tum", "g2o", "graphml", "csv", "png"])
def test_the_same_run_is_the_same_file(to: str, tmp_path: Path) -> None:
    short = AgainAndAgain(30)
    once, again = (export_run(short, to, tmp_path / f"{name}.{to}", Window(), silent) for name in ("a", "b"))
    assert [file.read_bytes() for file in once] == [file.read_bytes() for file in again]


@pytest.mark.parametrize("to", ["mcap", "csv", "g2o"])
def test_a_run_that_breaks_leaves_the_old_file(to: str, tmp_path: Path) -> None:
    def broken(_: Session) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "run").write_text("old")
    with pytest.raises(OSError, match="No space left on device"):
        export_run(AgainAndAgain(30, orders={20: broken}), to, tmp_path / "run", Window(), silent)
    assert [file.name for file in tmp_path.iterdir()] == ["run"]
    assert (tmp_path / "run").read_text() == "old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("to", ["mcap", "csv", "g2o", "mp4"])
def test_a_full_disk_is_named(to: str) -> None:
    with pytest.raises(OSError, match="No space left on device") as error:
        export_run(AgainAndAgain(30), to, Path("/dev/full"), Window(), silent)
    assert error.value.filename == "/dev/full"


@pytest.mark.parametrize("to", FORMATS)
def test_where_nothing_can_be_written_is_said_first(to: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="there is no folder"):
        check_export(to, tmp_path / "no" / f"run.{to}")


def test_the_map_as_json(at_the_end: Session) -> None:
    from app.export.mcap_file import topological_map

    said = json.loads(topological_map(at_the_end))
    map_ = at_the_end.brain.experience_map
    np.testing.assert_allclose(np.array(said["experiences"])[:, :3], map_.poses, atol=1e-4)
    assert [link[:2] for link in said["links"]] == map_.links.tolist()

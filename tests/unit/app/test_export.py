"""A run in the formats of other programs, read back by programs that are not ours. As MCAP, what the brain was given comes
back to the last bit."""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import cv2
import networkx as nx
import numpy as np
import pytest
from graphslam.graph import Graph
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from app.config import Config, from_toml
from app.export import FORMATS, Choices, Window, check_export, export_run
from app.export.mcap_file import topological_map
from app.export.text_formats import g2o_text
from app.session import Session
from ratslam_core import Odometry, RatSlam
from sim2d import SONAR_ANGLES_RAD

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
    *_, session = run.replay()
    return session


def written(run: AgainAndAgain, to: str, folder: Path, window: Window | None = None) -> Path:
    """The one file of an export."""
    (file,) = export_run(run, to, folder / f"run.{to}", window or Window(), silent)
    return file


def program(*words: object, folder: Path) -> str:
    """What a program says. Its settings go to a folder of the test's own."""
    own = os.environ | {"HOME": str(folder), "MPLBACKEND": "Agg"}
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120, env=own)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def rmse_of(said: str) -> float:
    return float(next(line.split()[1] for line in said.splitlines() if line.split()[:1] == ["rmse"]))


def test_the_map_as_a_pose_graph_is_the_map(run: AgainAndAgain, at_the_end: Session, tmp_path: Path) -> None:
    graph, map_ = Graph.from_g2o(str(written(run, "g2o", tmp_path))), at_the_end.brain.experience_map
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
    graph, map_ = nx.read_graphml(written(run, "graphml", tmp_path), node_type=int), at_the_end.brain.experience_map
    assert graph.is_directed()
    for i, (x, y, heading) in enumerate(map_.poses.tolist()):
        node = graph.nodes[i]
        assert (node["x"], node["y"], node["heading_rad"], node["view"]) == (x, y, heading, map_.views[i])
    assert set(graph.edges) == set(map(tuple, map_.links.tolist()))
    times = [graph.edges[i, j]["time_s"] for i, j in map_.links.tolist()]
    np.testing.assert_array_equal(times, map_.link_times)
    assert graph.edges[0, 1]["distance_m"] == map_.link(0, 1).distance_m
    goal = map_.active  # and networkx finds the quickest ways that the temporal map finds
    both_ways = nx.Graph()
    for i, j, time_s in graph.edges(data="time_s"):  # of two links the quicker one
        both_ways.add_edge(i, j, time_s=min(time_s, graph.edges.get((j, i), {"time_s": np.inf})["time_s"]))
    quickest = nx.single_source_dijkstra_path_length(both_ways, goal, weight="time_s")
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
    with written(run, "csv", tmp_path).open(encoding="utf-8", newline="") as text:
        rows = list(csv.DictReader(text))
    assert [int(row["tick"]) for row in rows] == list(range(TICKS + 1))
    for session, row in zip(run.replay(20), rows, strict=False):
        robot = session.estimate.pose_map_robot
        assert (float(row["x"]), float(row["y"]), float(row["heading_rad"])) == (robot.x, robot.y, robot.heading_rad)
        assert (float(row["speed"]), float(row["yaw_rate"])) == (session.odometry.speed, session.odometry.yaw_rate)
        assert int(row["experience"]) == session.brain.experience_map.active
    assert int(rows[-1]["experience"]) == at_the_end.brain.experience_map.active


def test_a_stretch_of_a_run(run: AgainAndAgain, tmp_path: Path) -> None:
    times = np.loadtxt(written(run, "csv", tmp_path, Window(10.0, 12.5)), delimiter=",", skiprows=1, usecols=1)
    np.testing.assert_allclose(times, np.arange(100, 126) / 10)
    assert written(run, "g2o", tmp_path, Window(until_s=5.0)).read_bytes() == g2o_text(a_session(50))
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


def test_the_same_run_is_the_same_file(tmp_path: Path, subtests: pytest.Subtests) -> None:
    short = AgainAndAgain(30)
    for to in ("mcap", "tum", "g2o", "graphml", "csv", "png"):
        with subtests.test(msg=to):
            once, again = (export_run(short, to, tmp_path / f"{name}.{to}", Window(), silent) for name in ("a", "b"))
            assert [file.read_bytes() for file in once] == [file.read_bytes() for file in again]


def test_a_run_that_breaks_leaves_the_old_file(tmp_path: Path, subtests: pytest.Subtests) -> None:
    def broken(_: Session) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "run").write_text("old")
    for to in ("mcap", "csv", "g2o"):
        with subtests.test(msg=to):
            with pytest.raises(OSError, match="No space left on device"):
                export_run(AgainAndAgain(30, orders={20: broken}), to, tmp_path / "run", Window(), silent)
            assert [file.name for file in tmp_path.iterdir()] == ["run"]
            assert (tmp_path / "run").read_text() == "old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_where_nothing_can_be_written_is_named(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for to in FORMATS:  # before the run is played
        with subtests.test(msg=f"no folder, {to}"), pytest.raises(ValueError, match="there is no folder"):
            check_export(to, tmp_path / "no" / f"run.{to}")
    for to in ("mcap", "csv", "g2o", "mp4"):
        with subtests.test(msg=f"full, {to}"):
            with pytest.raises(OSError, match="No space left on device") as error:
                export_run(AgainAndAgain(30), to, Path("/dev/full"), Window(), silent)
            assert error.value.filename == "/dev/full"


def test_the_map_as_json(at_the_end: Session) -> None:
    said = json.loads(topological_map(at_the_end))
    map_ = at_the_end.brain.experience_map
    np.testing.assert_allclose(np.array(said["experiences"])[:, :3], map_.poses, atol=1e-4)
    assert [link[:2] for link in said["links"]] == map_.links.tolist()


# ------------------------------------------------------------ MCAP

DRIVEN = 300


@pytest.fixture(scope="module")
def drive() -> AgainAndAgain:
    """On trips the pilot tells the map where a way failed, which no recording holds: so it wanders."""
    return AgainAndAgain(
        DRIVEN,
        config=Config().with_value("pilot.seek", False),
        orders={100: lambda s: s.kidnap(), 200: lambda s: s.set_parameter("robot.sensor_rate_hz", 12)},
    )


@pytest.fixture(scope="module")
def bag(drive: AgainAndAgain, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(drive, "mcap", tmp_path_factory.mktemp("bag"))


def messages(bag: Path, *topics: str) -> dict[str, list]:
    """All messages by topic, decoded by the MCAP project's own reader."""
    found: dict[str, list] = {}
    with bag.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, record, decoded in reader.iter_decoded_messages(topics=topics or None):
            found.setdefault(channel.topic, []).append((record.log_time, decoded))
    return found


def test_a_brain_that_is_given_the_recording_comes_to_the_same(drive: AgainAndAgain, bag: Path) -> None:
    with bag.open("rb") as file:
        (about,) = (record for record in make_reader(file).iter_metadata())
    config = from_toml(about.metadata["config"], Config())
    assert tomllib.loads(about.metadata["config"])["robot"]["sensor_rate_hz"] == 10
    brain_seed, _ = np.random.SeedSequence([int(about.metadata["seed"]), 1]).spawn(2)
    angles = tuple(json.loads(about.metadata["sonar_angles_rad"]))
    brain = RatSlam(config.engine, np.random.default_rng(brain_seed), sonar_angles_rad=angles)
    given = messages(bag)
    dts, behaviours = (dict(given[topic]) for topic in ("/dt", "/behaviour"))
    senses = (given[topic] for topic in ("/camera/image/compressed", "/odom", "/sonars"))
    dt = behaviour = None
    for (at, image), (_, odom), (_, sonars) in zip(*senses, strict=True):
        dt, behaviour = dts.get(at, dt), behaviours.get(at, behaviour)
        picture = cv2.cvtColor(cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
        assert dt is not None
        assert behaviour is not None
        told = Odometry(odom.twist.twist.linear.x, odom.twist.twist.angular.z, dt.data)
        brain.step(picture, told, behaviour=behaviour.data, ranges_m=np.array(sonars.data))
    *_, session = drive.replay()
    assert brain.digest() == session.brain.digest()


def test_what_is_in_it(drive: AgainAndAgain, bag: Path) -> None:
    found = messages(bag)
    of_each_tick = {"/camera/image/compressed", "/odom", "/scan", "/sonars", "/truth", "/estimate", "/tf"}
    of_each_change = {"/dt", "/behaviour", "/view_template", "/experience"}
    assert {topic for topic, of in found.items() if len(of) == DRIVEN + 1} == of_each_tick
    assert set(found) == of_each_tick | of_each_change | {"/map", "/topological_map", "/events"}
    views, view = dict(found["/view_template"]), None
    assert any(event.data.startswith("kidnap: ") for _, event in found["/events"])
    for tick, session in enumerate(drive.replay()):
        at_ns, truth = found["/truth"][tick]
        assert at_ns == round(session.time_s * 1e9) == truth.header.stamp.sec * 10**9 + truth.header.stamp.nanosec
        true, robot = session.simulator.truth, session.estimate.pose_map_robot
        assert (truth.pose.position.x, truth.pose.position.y) == (true.x, true.y)
        view = views.get(at_ns, view)
        assert view is not None
        assert view.data == session.estimate.recognition.view
        estimate = found["/estimate"][tick][1].pose
        assert (estimate.position.x, estimate.position.y) == (robot.x, robot.y)
        assert 2 * math.atan2(estimate.orientation.z, estimate.orientation.w) == pytest.approx(robot.heading_rad)
        drift, moved = (step.transform for step in found["/tf"][tick][1].transforms)  # map to odom to base_link
        turn = 2 * math.atan2(drift.rotation.z, drift.rotation.w)
        x, y = moved.translation.x, moved.translation.y
        assert drift.translation.x + math.cos(turn) * x - math.sin(turn) * y == pytest.approx(robot.x)
        assert drift.translation.y + math.sin(turn) * x + math.cos(turn) * y == pytest.approx(robot.y)
    *_, session = drive.replay()
    links, places = found["/map"][-1][1].markers
    assert (len(places.points), len(links.points)) == (
        len(session.brain.experience_map), 2 * session.brain.experience_map.link_count
    )  # fmt: skip


def test_the_sonars_stand_where_they_point(drive: AgainAndAgain, bag: Path) -> None:
    scan = messages(bag, "/scan")["/scan"][0][1]
    session = next(drive.replay())
    for angle, length in zip(SONAR_ANGLES_RAD, session.frame.ranges_m, strict=True):
        beam = (angle - scan.angle_min) / scan.angle_increment
        assert beam == pytest.approx(round(beam), abs=1e-5)
        assert np.float32(scan.ranges[round(beam)]) == length
    assert sum(math.isnan(length) for length in scan.ranges) == len(scan.ranges) - len(SONAR_ANGLES_RAD)


@pytest.mark.parametrize("fan_rad", [3.0, math.tau])
def test_a_laser_is_the_scan(fan_rad: float, tmp_path: Path) -> None:
    config = Config().with_values({"robot.laser_beams": 24, "robot.laser_fov_rad": fan_rad})
    run = AgainAndAgain(3, config=config)
    session, (_, scan) = next(run.replay()), messages(written(run, "mcap", tmp_path), "/scan")["/scan"][0]
    np.testing.assert_array_equal(np.array(scan.ranges, np.float32), session.frame.laser_m[::-1])
    assert scan.angle_max == pytest.approx(fan_rad / 2, rel=1e-6)


def test_rosbags_evo_and_rerun_read_it(bag: Path, tmp_path: Path) -> None:
    with AnyReader([bag]) as reader:
        connection = next(c for c in reader.connections if c.topic == "/odom")
        told = [reader.deserialize(raw, connection.msgtype) for _, _, raw in reader.messages([connection])]
    assert connection.msgcount == len(told) == DRIVEN + 1
    speeds = [odom.twist.twist.linear.x for _, odom in messages(bag, "/odom")["/odom"]]
    assert [odom.twist.twist.linear.x for odom in told] == speeds
    assert 0 < rmse_of(program(BIN / "evo_ape", "bag2", bag, "/truth", "/estimate", "-a", folder=tmp_path)) < 5
    program(BIN / "rerun", "mcap", "convert", bag, "-o", tmp_path / "run.rrd", folder=tmp_path)
    assert (tmp_path / "run.rrd").stat().st_size > 100_000


def test_without_pictures_it_is_small(drive: AgainAndAgain, bag: Path, tmp_path: Path) -> None:
    sizes = {}
    for pictures in ("jpeg", "none"):
        (file,) = export_run(drive, "mcap", tmp_path / pictures, Window(), silent, Choices(pictures))
        sizes[pictures] = file.stat().st_size
    assert sizes["none"] < sizes["jpeg"] < bag.stat().st_size
    assert sizes["none"] < 700 * DRIVEN

"""A run as MCAP: other programs read it, and what the brain was given comes back to the last bit."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from app.config import Config, from_toml
from app.export import Choices, Window, export_run
from ratslam_core import Odometry, RatSlam
from sim2d import SONAR_ANGLES_RAD

from .exported import AgainAndAgain, silent
from .test_export import BIN, program, rmse_of

pytestmark = pytest.mark.slow

TICKS = 300


@pytest.fixture(scope="module")
def run() -> AgainAndAgain:
    return AgainAndAgain(
        TICKS, orders={100: lambda s: s.kidnap(), 200: lambda s: s.set_parameter("robot.sensor_rate_hz", 12)}
    )


@pytest.fixture(scope="module")
def bag(run: AgainAndAgain, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export_run(run, "mcap", tmp_path_factory.mktemp("bag") / "run.mcap", Window(), silent)[0]


def messages(bag: Path, *topics: str) -> dict[str, list]:
    """All messages by topic, decoded by the MCAP project's own reader."""
    found: dict[str, list] = {}
    with bag.open("rb") as file:
        for _, channel, record, decoded in make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages(topics=topics or None):
            found.setdefault(channel.topic, []).append((record.log_time, decoded))
    return found


def test_a_brain_that_is_given_the_recording_comes_to_the_same(run: AgainAndAgain, bag: Path) -> None:
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
    *_, session = run.play()
    assert brain.digest() == session.brain.digest()


def test_what_is_in_it(run: AgainAndAgain, bag: Path) -> None:
    found = messages(bag)
    of_each_tick = {"/camera/image/compressed", "/odom", "/scan", "/sonars", "/truth", "/estimate", "/tf"}
    of_each_change = {"/dt", "/behaviour", "/view_template", "/experience"}
    assert {topic for topic, of in found.items() if len(of) == TICKS + 1} == of_each_tick
    assert set(found) == of_each_tick | of_each_change | {"/map", "/topological_map", "/events"}
    views, view = dict(found["/view_template"]), None
    assert any(event.data.startswith("kidnap: ") for _, event in found["/events"])
    for tick, session in enumerate(run.play()):
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
    *_, session = run.play()
    links, places = found["/map"][-1][1].markers
    assert (len(places.points), len(links.points)) == (
        len(session.brain.experience_map), 2 * session.brain.experience_map.link_count
    )  # fmt: skip


def test_the_sonars_stand_where_they_point(run: AgainAndAgain, bag: Path) -> None:
    scan = messages(bag, "/scan")["/scan"][0][1]
    session = next(run.play())
    for angle, length in zip(SONAR_ANGLES_RAD, session.frame.ranges_m, strict=True):
        beam = (angle - scan.angle_min) / scan.angle_increment
        assert beam == pytest.approx(round(beam), abs=1e-5)
        assert np.float32(scan.ranges[round(beam)]) == length
    assert sum(math.isnan(length) for length in scan.ranges) == len(scan.ranges) - len(SONAR_ANGLES_RAD)


@pytest.mark.parametrize("fan_rad", [3.0, math.tau])
def test_a_laser_is_the_scan(fan_rad: float, tmp_path: Path) -> None:
    config = Config().with_values({"robot.laser_beams": 24, "robot.laser_fov_rad": fan_rad})
    run = AgainAndAgain(3, config=config)
    (bag,) = export_run(run, "mcap", tmp_path / "run.mcap", Window(), silent)
    session, (_, scan) = next(run.play()), messages(bag, "/scan")["/scan"][0]
    np.testing.assert_array_equal(np.array(scan.ranges, np.float32), session.frame.laser_m[::-1])
    assert scan.angle_max == pytest.approx(fan_rad / 2, rel=1e-6)


def test_rosbags_reads_it(bag: Path) -> None:
    with AnyReader([bag]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        connection = next(c for c in reader.connections if c.topic == "/odom")
        speeds = [
            reader.deserialize(raw, connection.msgtype).twist.twist.linear.x
            for _, _, raw in reader.messages([connection])
        ]
    assert counts["/odom"] == len(speeds) == TICKS + 1
    assert speeds == [odom.twist.twist.linear.x for _, odom in messages(bag, "/odom")["/odom"]]


def test_evo_judges_it(bag: Path, tmp_path: Path) -> None:
    said = program(BIN / "evo_ape", "bag2", bag, "/truth", "/estimate", "-a", folder=tmp_path)
    assert 0 < rmse_of(said) < 5


def test_rerun_converts_it(bag: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.rrd"
    program(BIN / "rerun", "mcap", "convert", bag, "-o", out, folder=tmp_path)
    assert out.stat().st_size > 100_000


def test_without_pictures_it_is_small(run: AgainAndAgain, bag: Path, tmp_path: Path) -> None:
    sizes = {}
    for pictures in ("jpeg", "none"):
        (file,) = export_run(run, "mcap", tmp_path / pictures, Window(), silent, Choices(pictures))
        sizes[pictures] = file.stat().st_size
    assert sizes["none"] < sizes["jpeg"] < bag.stat().st_size
    assert sizes["none"] < 700 * TICKS

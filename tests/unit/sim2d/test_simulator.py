"""The robot in its office: what it is told to do, what it tells, and that a seed is a run, bit for bit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np
import pytest

from sim2d import SONAR_ANGLES_RAD, Drive, Person, SensorFrame, SimParams, Simulator, load_world

from .rooms import EXACT, FORWARD, STAY, room, run, wall


def wandering(simulator: Simulator, ticks: int) -> Iterator[SensorFrame]:
    """Another drive every one and a half seconds."""
    rng = np.random.default_rng(0)
    for k in range(ticks):
        if k % 15 == 0:
            drive = Drive(rng.uniform(-0.3, 0.5), rng.uniform(-1.6, 1.6))
        yield simulator.step(drive)


def wander(simulator: Simulator, ticks: int) -> list[SensorFrame]:
    return list(wandering(simulator, ticks))


def same(a: SensorFrame, b: SensorFrame) -> bool:
    return all(np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(SensorFrame))


def test_the_first_frame_is_that_of_a_robot_at_rest_and_does_not_tell_the_truth() -> None:
    """Except for the number of the scene, which the papers' simulator gave; only the front end for it receives it."""
    simulator = Simulator(load_world("office"), seed=4)
    frame, truth, start = simulator.observe(), simulator.truth, simulator.world.starts[0]
    assert {f.name for f in fields(SensorFrame)} - {"scene"} == {
        "tick", "time_s", "image", "odometry_speed", "odometry_yaw_rate", "dt", "ranges_m", "bumped", "laser_m",
    }  # fmt: skip
    assert (frame.tick, frame.time_s, frame.dt) == (0, 0.0, 0.1)
    assert (frame.odometry_speed, frame.odometry_yaw_rate, frame.bumped) == (0.0, 0.0, False)
    assert (frame.image.shape, frame.image.dtype, frame.image.flags.writeable) == ((48, 64, 3), np.uint8, False)
    assert frame.ranges_m.shape == (len(SONAR_ANGLES_RAD),)
    assert simulator.observe() is frame
    assert (truth.x, truth.y, truth.heading_rad) == (start.x, start.y, start.heading_rad)
    assert (truth.speed, truth.yaw_rate) == (0.0, 0.0)
    other = Simulator(room(), SimParams(image_width=20, image_height=10)).observe()
    assert other.image.shape == (10, 20, 3)


def test_it_drives_as_told_as_fast_as_it_can() -> None:
    simulator = Simulator(room(), EXACT)
    frame = run(simulator, Drive(0.3, 0.0), 20)
    assert (frame.time_s, frame.odometry_speed) == pytest.approx((2.0, 0.3), abs=1e-6)
    assert simulator.truth.x == pytest.approx(2.0 + 0.3 * 2.0 - 0.5 * 0.3**2, abs=0.005)  # 1 m/s^2 up to 0.3 m/s
    assert simulator.truth.y == pytest.approx(2.0, abs=1e-9)
    run(simulator, Drive(0.0, 1.0), 30)
    assert simulator.truth.yaw_rate == pytest.approx(1.0, abs=1e-6)
    assert simulator.truth.heading_rad == pytest.approx(3.0 - 0.5 / 6, abs=0.02)
    frame = run(Simulator(room(side=20), EXACT), Drive(99.0, -99.0), 20)
    assert (frame.odometry_speed, frame.odometry_yaw_rate) == pytest.approx((0.5, -math.pi / 2), abs=1e-3)
    with pytest.raises(ValueError, match=r"a drive must be finite, got speed nan, yaw_rate 0.0"):
        Drive(math.nan, 0.0)


def test_encoders_without_errors_add_up_to_the_true_pose_and_say_zero_at_rest() -> None:
    simulator = Simulator(room(side=20), EXACT)
    x, y, heading = 10.0, 10.0, 0.0
    for frame in wandering(simulator, 300):
        turn = frame.odometry_yaw_rate * frame.dt
        x += frame.odometry_speed * frame.dt * math.cos(heading + turn / 2)
        y += frame.odometry_speed * frame.dt * math.sin(heading + turn / 2)
        heading += turn
        assert frame.odometry_speed == simulator.truth.speed
    assert math.dist((x, y), (simulator.truth.x, simulator.truth.y)) < 0.02
    frame = run(Simulator(room(), SimParams(gyro_bias=0.1)), STAY, 5)
    assert (frame.odometry_speed, frame.odometry_yaw_rate) == (0.0, 0.0)


def test_pushing_against_a_wall() -> None:
    simulator = Simulator(room(), EXACT)
    assert not run(simulator, FORWARD, 11).bumped
    frame = run(simulator, FORWARD, 69)
    assert frame.bumped
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)
    assert frame.odometry_speed == 0.0  # the wheels stall: no counts
    assert frame.ranges_m[3] == pytest.approx(0.22 / math.cos(math.radians(2.5)), abs=0.003)
    assert not run(simulator, Drive(-0.3, 0.0), 10).bumped


def test_a_seed_is_a_run_with_all_that_lives_in_the_office_and_a_reset_begins_it() -> None:
    world = load_world("living")
    used, one, other = (Simulator(world, seed=seed) for seed in (1, 9, 2))
    wander(used, 40)
    used.teleport(*used.random_free_pose())
    used.reset(9)
    assert used.digest() == one.digest()
    assert all(same(a, b) for a, b in zip(wander(used, 100), wander(one, 100), strict=True))
    assert used.digest() == one.digest()
    assert used.random_free_pose() == one.random_free_pose()
    assert not same(wander(other, 100)[-1], one.observe())
    assert not np.array_equal(one.actors.walkers.xy, other.actors.walkers.xy)
    before = one.digest()
    one.actors.walkers.xy[0, 0] += 1e-9
    assert one.digest() != before
    one.actors.walkers.xy[:] = used.actors.walkers.xy
    one.step(Drive(0.1, 0.0))
    assert one.digest() != before


def test_it_can_be_put_elsewhere_where_there_is_room() -> None:
    simulator = Simulator(room(wall(0.5, 1.0, 1.5, 1.0, kind="desk", height=0.75)), EXACT)
    wander(simulator, 20)
    before = simulator.observe()
    simulator.teleport(3.0, 1.0, 4.0)
    truth, frame = simulator.truth, simulator.observe()
    assert (truth.x, truth.y, truth.heading_rad) == (3.0, 1.0, pytest.approx(4.0 - 2 * math.pi))
    assert frame.tick == before.tick
    assert not np.array_equal(frame.image, before.image)
    assert (frame.odometry_speed, frame.odometry_yaw_rate, simulator.step(STAY).odometry_speed) == (0.0, 0.0, 0.0)
    digest = simulator.digest()
    for pose, reason in (
        ((9.0, 1.0, 0.0), r"\(9, 1\) is outside of room, which spans 0 to 4 by 0 to 4 m"),
        ((1.0, 1.1, 0.0), r"\(1, 1.1\) is 0.100 m from walls\[4\] \(desk\); the robot needs 0.22 m"),
        ((math.nan, 1.0, 0.0), r"\(nan, 1.0\) is not a place"),
        ((1.0, math.inf, 0.0), r"\(1.0, inf\) is not a place"),
        ((3.0, 3.0, math.nan), r"heading must be finite, got nan"),
    ):
        with pytest.raises(ValueError, match=reason):
            simulator.teleport(*pose)
        assert simulator.digest() == digest


def test_errors_of_the_encoders_change_while_it_runs() -> None:
    simulator = Simulator(room(), EXACT)
    simulator.set_params(replace(EXACT, odometry_scale_error=0.5))
    assert run(simulator, Drive(0.3, 0.0), 10).odometry_speed == pytest.approx(1.5 * simulator.truth.speed)


def test_walls_become_rough_while_it_runs() -> None:
    """At 45 degrees to a wall: smooth, it slides along; as rough as can be, it stays where it is."""
    simulator = Simulator(room(), replace(EXACT, friction=0.0))
    simulator.teleport(4.0 - 0.22, 1.0, math.pi / 4)
    for friction, speed in ((0.0, 0.3 / math.sqrt(2)), (1.0, 0.0), (0.0, 0.3 / math.sqrt(2))):
        simulator.set_params(replace(EXACT, friction=friction))
        run(simulator, Drive(0.3, 0.0), 9)
        before = simulator.truth.y
        simulator.step(Drive(0.3, 0.0))
        assert simulator.truth.y - before == pytest.approx(0.1 * speed, abs=2e-4)


def test_a_slippery_floor_is_slippery_near_and_far_from_walls() -> None:
    """Far from walls the robot needs no pymunk, near to them it does: both speed up by 4 N on 8 kg."""
    for x, y in ((10.0, 10.0), (10.0, 0.24)):
        simulator = Simulator(room(side=20), EXACT)
        simulator.teleport(x, y, 0.0)
        simulator.set_params(replace(EXACT, grip_n=4.0))
        speeds = [simulator.step(FORWARD).odometry_speed for _ in range(9)]
        assert np.diff(speeds) == pytest.approx(np.full(8, 0.05), abs=1e-6)


def test_rates_change_while_it_runs_and_time_goes_on() -> None:
    people = (Person("Ada", ((0.5, 0.5), (3.5, 0.5)), (0.0, 0.0), speed=0.8),)
    simulator = Simulator(room(people=people), EXACT)
    run(simulator, Drive(0.4, 0.0), 10)
    at, walked = simulator.truth.x, simulator.actors.walkers.xy[0, 0]
    simulator.set_params(replace(EXACT, sensor_rate_hz=20, physics_rate_hz=480))
    frames = [simulator.step(Drive(0.4, 0.0)) for _ in range(10)]
    assert [frame.time_s for frame in frames] == pytest.approx(1 + np.arange(1, 11) / 20)
    assert (frames[-1].dt, frames[-1].odometry_speed) == (0.05, pytest.approx(0.4))
    assert simulator.truth.x - at == pytest.approx(0.2, abs=0.01)  # half a second
    assert simulator.actors.walkers.xy[0, 0] - walked == pytest.approx(0.4, abs=0.01)


def test_the_robot_grows_where_there_is_room() -> None:
    simulator = Simulator(room(), EXACT)
    simulator.teleport(0.48, 2.0, math.pi)
    before = simulator.digest()
    reason = r"robot_radius_m cannot become 0\.5 here: .* would cover the robot at \(0\.48, 2\.00\); keep"
    with pytest.raises(ValueError, match=reason):
        simulator.set_params(replace(EXACT, robot_radius_m=0.5))
    assert simulator.digest() == before
    simulator.set_params(replace(EXACT, robot_radius_m=0.4))
    run(simulator, FORWARD, 20)
    assert simulator.truth.x == pytest.approx(0.4, abs=0.004)
    with pytest.raises(ValueError, match=r"the robot needs 0\.4 m"):
        simulator.teleport(0.3, 2.0, 0.0)
    with pytest.raises(ValueError, match=r"room: the robot cannot start at home: .* 0.400 m from .* needs 0.5 m"):
        Simulator(room(side=0.8), SimParams(robot_radius_m=0.5))

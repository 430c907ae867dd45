from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from sim2d import SONAR_ANGLES_RAD, Drive, Person, SensorFrame, SimParams, Simulator, Wall, load_world, world_names

from .rooms import GREY, room

EXACT = SimParams(odometry_noise=0.0, odometry_scale_error=0.0, gyro_bias=0.0, sonar_noise_m=0.0, image_noise=0.0)


def wandering(ticks: int, seed: int = 0) -> list[Drive]:
    rng = np.random.default_rng(seed)
    drives = [Drive(rng.uniform(-0.3, 0.5), rng.uniform(-1.6, 1.6)) for _ in range(ticks // 15 + 1)]
    return [drives[k // 15] for k in range(ticks)]


def wander(simulator: Simulator, ticks: int) -> list[SensorFrame]:
    return [simulator.step(drive) for drive in wandering(ticks)]


def same(a: SensorFrame, b: SensorFrame) -> bool:
    return all(np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(SensorFrame))


def test_the_first_frame() -> None:
    simulator = Simulator(load_world("office"), seed=4)
    frame = simulator.observe()
    assert (frame.tick, frame.time_s, frame.dt) == (0, 0.0, 0.1)
    assert (frame.odometry_speed, frame.odometry_yaw_rate, frame.bumped) == (0.0, 0.0, False)
    assert frame.image.shape == (48, 64, 3)
    assert frame.image.dtype == np.uint8
    assert frame.ranges_m.shape == (len(SONAR_ANGLES_RAD),)
    assert simulator.observe() is frame
    assert not frame.image.flags.writeable
    start = simulator.world.starts[0]
    truth = simulator.truth
    assert (truth.x, truth.y, truth.heading_rad) == (start.x, start.y, start.heading_rad)
    assert (truth.speed, truth.yaw_rate) == (0.0, 0.0)


def test_the_frame_does_not_tell_the_truth() -> None:
    """Except for the number of the scene, which the papers' simulator gave; only the front end for it receives it."""
    names = {f.name for f in fields(SensorFrame)} - {"scene"}
    assert names == {
        "tick", "time_s", "image", "odometry_speed", "odometry_yaw_rate", "dt", "ranges_m", "bumped", "laser_m",
    }  # fmt: skip


def test_drives_as_told() -> None:
    simulator = Simulator(room(), EXACT)
    for _ in range(20):
        frame = simulator.step(Drive(0.3, 0.0))
    assert frame.time_s == pytest.approx(2.0)
    assert frame.odometry_speed == pytest.approx(0.3, abs=1e-6)
    assert simulator.truth.x == pytest.approx(2.0 + 0.3 * 2.0 - 0.5 * 0.3**2, abs=0.005)  # 1 m/s^2 up to 0.3 m/s
    assert simulator.truth.y == pytest.approx(2.0, abs=1e-9)
    for _ in range(30):
        simulator.step(Drive(0.0, 1.0))
    assert simulator.truth.yaw_rate == pytest.approx(1.0, abs=1e-6)
    assert simulator.truth.heading_rad == pytest.approx(3.0 - 0.5 / 6, abs=0.02)


def test_commands_are_cut_to_what_the_robot_can() -> None:
    simulator = Simulator(room(side=20), EXACT)
    for _ in range(20):
        frame = simulator.step(Drive(99.0, -99.0))
    assert frame.odometry_speed == pytest.approx(0.5, abs=1e-3)
    assert frame.odometry_yaw_rate == pytest.approx(-math.pi / 2, abs=1e-3)
    with pytest.raises(ValueError, match=r"a drive must be finite, got speed nan, yaw_rate 0.0"):
        Drive(math.nan, 0.0)


def test_exact_encoders_integrate_to_the_true_pose() -> None:
    simulator = Simulator(room(side=20), EXACT)
    x, y, heading = 10.0, 10.0, 0.0
    for drive in wandering(300):
        frame = simulator.step(drive)
        turn = frame.odometry_yaw_rate * frame.dt
        x += frame.odometry_speed * frame.dt * math.cos(heading + turn / 2)
        y += frame.odometry_speed * frame.dt * math.sin(heading + turn / 2)
        heading += turn
        assert frame.odometry_speed == simulator.truth.speed
    assert math.dist((x, y), (simulator.truth.x, simulator.truth.y)) < 0.02


def test_at_rest_the_encoders_say_zero_exactly() -> None:
    simulator = Simulator(room(), SimParams(gyro_bias=0.1))
    for _ in range(5):
        frame = simulator.step(Drive(0.0, 0.0))
        assert (frame.odometry_speed, frame.odometry_yaw_rate) == (0.0, 0.0)


def test_pushing_against_a_wall() -> None:
    simulator = Simulator(room(), EXACT)
    frames = [simulator.step(Drive(0.5, 0.0)) for _ in range(80)]
    assert not frames[10].bumped
    assert frames[-1].bumped
    assert simulator.truth.x == pytest.approx(4.0 - 0.22, abs=0.003)
    assert frames[-1].odometry_speed == 0.0  # the wheels stall: no counts
    assert frames[-1].ranges_m[3] == pytest.approx(0.22 / math.cos(math.radians(2.5)), abs=0.003)
    away = [simulator.step(Drive(-0.3, 0.0)) for _ in range(10)][-1]
    assert not away.bumped


@pytest.mark.parametrize("name", [name for name, _ in world_names()])
@pytest.mark.slow
def test_never_a_centimetre_into_a_wall(name: str) -> None:
    """Three minutes of wild driving from four places."""
    simulator = Simulator(load_world(name), seed=1)
    bumps = 0
    for part in range(4):
        simulator.teleport(*simulator.random_free_pose())
        rng = np.random.default_rng(part)
        for k in range(450):
            if k % 12 == 0:
                drive = Drive(rng.choice([-0.5, 0.5]), rng.uniform(-1, 1))
            bumps += simulator.step(drive).bumped
            assert simulator.free_space.clearance(simulator.truth.x, simulator.truth.y) > 0.22 - 0.01
            assert simulator.free_space.is_free(*near(simulator))
    assert bumps > 20


def near(simulator: Simulator) -> tuple[float, float]:
    """The robot's place, moved out of the millimetre by which it may press into a wall."""
    truth, space = simulator.truth, simulator.free_space
    rng = np.random.default_rng(0)
    for _ in range(200):
        x, y = truth.x + rng.uniform(-0.02, 0.02), truth.y + rng.uniform(-0.02, 0.02)
        if space.is_free(x, y):
            return x, y
    return truth.x, truth.y


def test_same_seed_same_drives_same_frames() -> None:
    world = load_world("office")
    one, two = Simulator(world, seed=9), Simulator(world, seed=9)
    assert all(same(a, b) for a, b in zip(wander(one, 100), wander(two, 100), strict=True))
    assert one.digest() == two.digest()
    assert one.random_free_pose() == two.random_free_pose()
    first = one.digest()
    one.step(Drive(0.1, 0.0))
    assert one.digest() != first


def test_reset_is_a_new_simulator() -> None:
    world = load_world("office")
    used, new = Simulator(world, seed=1), Simulator(world, seed=2)
    wander(used, 40)
    used.teleport(*used.random_free_pose())
    used.reset(2)
    assert used.digest() == new.digest()
    assert all(same(a, b) for a, b in zip(wander(used, 60), wander(new, 60), strict=True))


def test_another_seed_is_another_run() -> None:
    world = load_world("office")
    assert not same(wander(Simulator(world, seed=1), 3)[-1], wander(Simulator(world, seed=2), 3)[-1])


def test_teleport() -> None:
    simulator = Simulator(room(), EXACT)
    wander(simulator, 20)
    before = simulator.observe()
    simulator.teleport(3.0, 1.0, 4.0)
    truth = simulator.truth
    assert (truth.x, truth.y) == (3.0, 1.0)
    assert truth.heading_rad == pytest.approx(4.0 - 2 * math.pi)
    frame = simulator.observe()
    assert frame.tick == before.tick
    assert not np.array_equal(frame.image, before.image)
    assert (frame.odometry_speed, frame.odometry_yaw_rate) == (0.0, 0.0)
    assert simulator.step(Drive(0.0, 0.0)).odometry_speed == 0.0


@pytest.mark.parametrize(
    ("pose", "reason"),
    [
        ((9.0, 1.0, 0.0), r"\(9, 1\) is outside of room, which spans 0 to 4 by 0 to 4 m"),
        ((1.0, 1.1, 0.0), r"\(1, 1.1\) is 0.100 m from walls\[4\] \(desk\); the robot needs 0.22 m"),
        ((math.nan, 1.0, 0.0), r"\(nan, 1.0\) is not a place"),
        ((1.0, math.inf, 0.0), r"\(1.0, inf\) is not a place"),
        ((3.0, 3.0, math.nan), r"heading must be finite, got nan"),
    ],
)
def test_teleport_refuses_and_leaves_all_as_it_was(pose: tuple[float, float, float], reason: str) -> None:
    simulator = Simulator(room(Wall(0.5, 1.0, 1.5, 1.0, "desk", 0.75, GREY)))
    before = simulator.digest()
    with pytest.raises(ValueError, match=reason):
        simulator.teleport(*pose)
    assert simulator.digest() == before


def test_random_poses_are_free() -> None:
    simulator = Simulator(load_world("loop"), seed=3)
    poses = [simulator.random_free_pose() for _ in range(100)]
    for pose in poses:
        simulator.teleport(*pose)
    assert np.std([heading for *_, heading in poses]) > 1.0


def test_live_parameters() -> None:
    simulator = Simulator(room(), EXACT)
    simulator.set_params(replace(EXACT, odometry_scale_error=0.5, light=0.5))
    for _ in range(10):
        frame = simulator.step(Drive(0.3, 0.0))
    assert frame.odometry_speed == pytest.approx(1.5 * simulator.truth.speed)
    assert simulator.params.light == 0.5


def test_walls_become_rough_while_it_runs() -> None:
    """At 45 degrees to a wall: smooth, it slides along; as rough as can be, it stays where it is."""
    simulator = Simulator(room(), replace(EXACT, friction=0.0))
    simulator.teleport(4.0 - 0.22, 1.0, math.pi / 4)
    for friction, speed in ((0.0, 0.3 / math.sqrt(2)), (1.0, 0.0), (0.0, 0.3 / math.sqrt(2))):
        simulator.set_params(replace(EXACT, friction=friction))
        for _ in range(10):
            before = simulator.truth.y
            simulator.step(Drive(0.3, 0.0))
        assert simulator.truth.y - before == pytest.approx(0.1 * speed, abs=2e-4)


def test_a_slippery_floor_is_slippery_near_and_far_from_walls() -> None:
    """Far from walls the robot needs no pymunk, near to them it does: both speed up by 4 N on 8 kg."""
    for x, y in ((10.0, 10.0), (10.0, 0.24)):
        simulator = Simulator(room(side=20), EXACT)
        simulator.teleport(x, y, 0.0)
        simulator.set_params(replace(EXACT, grip_n=4.0))
        speeds = [simulator.step(Drive(0.5, 0.0)).odometry_speed for _ in range(9)]
        assert np.diff(speeds) == pytest.approx(np.full(8, 0.05), abs=1e-6)


def test_rates_change_while_it_runs_and_time_goes_on() -> None:
    people = (Person("Ada", ((0.5, 0.5), (3.5, 0.5)), (0.0, 0.0), speed=0.8),)
    simulator = Simulator(replace(room(), people=people), EXACT)
    times = [simulator.step(Drive(0.4, 0.0)).time_s for _ in range(10)]
    at, walked = simulator.truth.x, simulator.actors.walkers.xy[0, 0]
    simulator.set_params(replace(EXACT, sensor_rate_hz=20, physics_rate_hz=480))
    frames = [simulator.step(Drive(0.4, 0.0)) for _ in range(10)]
    assert times + [frame.time_s for frame in frames] == pytest.approx(
        [*np.arange(1, 11) / 10, *(1 + np.arange(1, 11) / 20)]
    )
    assert frames[-1].dt == 0.05
    assert frames[-1].odometry_speed == pytest.approx(0.4)
    assert simulator.truth.x - at == pytest.approx(0.2, abs=0.01)  # half a second
    assert simulator.actors.walkers.xy[0, 0] - walked == pytest.approx(0.4, abs=0.01)


def test_the_robot_grows_where_there_is_room() -> None:
    simulator = Simulator(room(), EXACT)
    reason = r"robot_radius_m cannot become 0\.5 here: .* would cover the robot at \(0\.48, 2\.00\); keep"
    simulator.teleport(0.48, 2.0, math.pi)
    before = simulator.digest()
    with pytest.raises(ValueError, match=reason):
        simulator.set_params(replace(EXACT, robot_radius_m=0.5))
    assert simulator.digest() == before
    simulator.set_params(replace(EXACT, robot_radius_m=0.4))
    for _ in range(20):
        simulator.step(Drive(0.5, 0.0))
    assert simulator.truth.x == pytest.approx(0.4, abs=0.004)
    with pytest.raises(ValueError, match=r"the robot needs 0\.4 m"):
        simulator.teleport(0.3, 2.0, 0.0)


def test_a_robot_too_large_for_its_start() -> None:
    with pytest.raises(ValueError, match=r"room: the robot cannot start at home: .* 0.400 m from .* needs 0.5 m"):
        Simulator(room(side=0.8), SimParams(robot_radius_m=0.5))


def test_other_images() -> None:
    frame = Simulator(room(), SimParams(image_width=20, image_height=10)).observe()
    assert frame.image.shape == (10, 20, 3)

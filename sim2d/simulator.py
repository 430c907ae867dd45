"""The simulated robot in its office: drive commands in, what its sensors say out. It does not know that SLAM exists."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, fields

import numpy as np
import pymunk
from numpy.typing import NDArray

from sim2d.camera import Camera
from sim2d.free_space import FreeSpace
from sim2d.geometry import nearest_segment
from sim2d.odometer import report, true_motion, wrap_angle
from sim2d.params import SimParams
from sim2d.ranges import SONAR_ANGLES_RAD, sonar_ranges
from sim2d.robot import Robot
from sim2d.world import World

BUMPER_M = 0.005  # travel of the contact ring around the robot


@dataclass(frozen=True, slots=True)
class Drive:
    """A command for one tick: m/s forwards, rad/s counter-clockwise; cut to what the robot can do."""

    speed: float
    yaw_rate: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.speed) and math.isfinite(self.yaw_rate)):
            raise ValueError(f"a drive must be finite, got speed {self.speed}, yaw_rate {self.yaw_rate}")


@dataclass(frozen=True, slots=True)
class Truth:
    """Where the robot really is, for judging and for drawing, never for the robot. Office frame."""

    x: float
    y: float
    heading_rad: float
    speed: float  # mean over the last tick
    yaw_rate: float


@dataclass(frozen=True, slots=True, eq=False)
class SensorFrame:
    """All that the robot senses at the end of a tick."""

    tick: int
    time_s: float  # simulated
    image: NDArray[np.uint8]  # (height, width, 3) RGB
    odometry_speed: float  # m/s, mean over the tick, with errors
    odometry_yaw_rate: float  # rad/s
    dt: float  # seconds
    ranges_m: NDArray[np.float32]  # (8,) from the robot's middle, left to right as SONAR_ANGLES_RAD
    bumped: bool  # the bumper touches something


class Simulator:
    """One robot in one world; the only owner of its pymunk.Space. Use it from one thread."""

    def __init__(self, world: World, params: SimParams | None = None, seed: int = 0) -> None:
        self.world = world
        self.params = params or SimParams()
        self.free_space = FreeSpace(world, self.params.robot_radius_m)
        self._obstacles = world.segments()[list(world.obstacles)]
        self._angles = np.array(SONAR_ANGLES_RAD)
        refusal = self.free_space.refusal(world.starts[0].x, world.starts[0].y)
        if refusal is not None:
            raise ValueError(f"{world.name}: the robot cannot start at {world.starts[0].name}: {refusal}")
        self._camera = Camera(world, self.params)
        self.reset(seed)

    def reset(self, seed: int) -> None:
        """Begin anew at the first start pose. Same seed and same calls afterwards: the same frames, bit for bit."""
        self._image_rng, self._sonar_rng, self._odometry_rng, self._pose_rng, bank_rng = (
            np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(5)
        )
        self._camera.new_noise(bank_rng)
        self._space = _walled_space(self.world)
        start = self.world.starts[0]
        self._robot = Robot(self._space, self.params, start.x, start.y, start.heading_rad)
        self._tick = 0
        self._motion = (0.0, 0.0)
        self._frame = self._sense(0.0, 0.0)

    @property
    def truth(self) -> Truth:
        """The true pose and motion."""
        x, y, heading = self._pose()
        return Truth(x, y, wrap_angle(heading), *self._motion)

    def observe(self) -> SensorFrame:
        """What was sensed last: at the start, after the last step or after a teleport. Nothing advances."""
        return self._frame

    def step(self, drive: Drive) -> SensorFrame:
        """Drive for one tick, then sense."""
        before = self._pose()
        self._robot.drive(self._space, drive.speed, drive.yaw_rate, self.params)
        self._tick += 1
        self._motion = true_motion(before, self._pose(), self.params.tick_s)
        self._frame = self._sense(*report(*self._motion, self.params, self._odometry_rng))
        return self._frame

    def teleport(self, x: float, y: float, heading_rad: float) -> None:
        """Put the robot elsewhere, at rest; its encoders do not notice.

        ValueError with the reason when it cannot be there: outside, in a wall (which, how far), closed in, not finite.
        """
        if not math.isfinite(heading_rad):
            raise ValueError(f"heading must be finite, got {heading_rad}")
        refusal = self.free_space.refusal(x, y)
        if refusal is not None:
            raise ValueError(refusal)
        self._robot.place(x, y, heading_rad)
        self._space.reindex_shapes_for_body(self._robot.body)
        self._motion = (0.0, 0.0)
        self._frame = self._sense(0.0, 0.0)

    def random_free_pose(self) -> tuple[float, float, float]:
        """A pose on free floor, from the simulator's own generator: x, y, heading in (-pi, pi]."""
        x, y = self.free_space.random_point(self._pose_rng)
        return x, y, wrap_angle(float(self._pose_rng.uniform(-math.pi, math.pi)))

    def set_params(self, params: SimParams) -> None:
        """Change what may change while running; ValueError that names anything else."""
        for item in fields(params):
            old, new = getattr(self.params, item.name), getattr(params, item.name)
            if old != new and not item.metadata["live"]:
                raise ValueError(
                    f"{item.name} cannot change while running (from {old!r} to {new!r}); make a new simulator"
                )
        self.params = params

    def state(self) -> bytes:
        """Digest of everything that decides the future: equal histories give equal digests."""
        body = self._robot.body
        numbers = [*self._pose(), *body.velocity, body.angular_velocity, self._robot.speed, self._robot.yaw_rate]
        digest = hashlib.sha256(np.array([self._tick, *self._motion, *numbers], np.float64).tobytes())
        for rng in (self._image_rng, self._sonar_rng, self._odometry_rng, self._pose_rng):
            digest.update(repr(rng.bit_generator.state).encode())
        digest.update(self._frame.image.tobytes())
        digest.update(repr(self.params).encode())
        return digest.digest()

    def _pose(self) -> tuple[float, float, float]:
        x, y = self._robot.body.position
        return x, y, self._robot.body.angle

    def _sense(self, speed: float, yaw_rate: float) -> SensorFrame:
        params = self.params
        x, y, heading = self._pose()
        image = self._camera.image(x, y, heading, params.light, params.image_noise, self._image_rng)
        errors = self._sonar_rng.standard_normal(len(SONAR_ANGLES_RAD)) * params.sonar_noise_m
        ranges = sonar_ranges(self._obstacles, x, y, heading, self._angles, params.sonar_range_m, errors)
        image.setflags(write=False)
        ranges.setflags(write=False)
        bumped = nearest_segment(self._obstacles, x, y)[1] < params.robot_radius_m + BUMPER_M
        return SensorFrame(
            self._tick, self._tick / params.sensor_rate_hz, image, speed, yaw_rate, params.tick_s, ranges, bumped
        )


def _walled_space(world: World) -> pymunk.Space:
    space = pymunk.Space()
    space.collision_slop = 0.001  # metres of overlap that the solver leaves alone; pymunk's own is for pixels
    for number in world.obstacles:
        wall = world.walls[number]
        segment = pymunk.Segment(space.static_body, (wall.x1, wall.y1), (wall.x2, wall.y2), 0.0)
        segment.friction = 0.3
        space.add(segment)
    return space

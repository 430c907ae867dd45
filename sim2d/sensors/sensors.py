"""All sensors of the robot: camera, sonars, bumper, laser, wheels. Each has a generator of its own for its errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from disk import kind
from sim2d.actors.actors import Actors
from sim2d.camera.camera import Camera
from sim2d.geometry.wall_index import build_index
from sim2d.params import SimParams
from sim2d.sensors.odometer import report
from sim2d.sensors.ranges import SONAR_ANGLES_RAD, is_clear, laser_ranges, sonar_ranges
from sim2d.sensors.scene_numbers import scene_number
from sim2d.world.world import World

_OWNERS = ("image", "sonar", "odometry", "pose", "noise bank", "actors", "echo", "laser")

Pose = tuple[float, float, float]


@kind("sensor frame/1")
@dataclass(frozen=True, slots=True, eq=False)
class SensorFrame:
    """Everything that the robot senses at the end of a tick."""

    tick: int
    time_s: float  # simulated
    image: NDArray[np.uint8]  # (height, width, 3) RGB
    odometry_speed: float  # m/s, mean over the tick, with errors
    odometry_yaw_rate: float  # rad/s
    dt: float  # seconds
    ranges_m: NDArray[np.float32]  # (8,) from the robot's middle, left to right as SONAR_ANGLES_RAD
    bumped: bool  # whether the bumper touches something
    laser_m: NDArray[np.float32]  # (laser_beams,) from the robot's middle, left to right over laser_fov_rad
    scene: int  # number of the true pose's square and sector, for brains that see only numbers, as in the papers

    def freeze(self) -> SensorFrame:
        """Make its arrays read-only, since others keep references to them."""
        for array in (self.image, self.ranges_m, self.laser_m):
            array.setflags(write=False)
        return self


def seeds(seed: int) -> dict[str, np.random.SeedSequence]:
    """A seed for each owner of random numbers in a simulator, so that none draws from another's stream."""
    return dict(zip(_OWNERS, np.random.SeedSequence(seed).spawn(len(_OWNERS)), strict=True))


@kind("sensors/1")
class Sensors:
    """The sensors of one robot. They sense the world and the actors that were set last."""

    CACHES = ("_angles", "_world", "_actors", "_walls", "_obstacles", "_opaque", "_camera")

    def __init__(self, world: World, params: SimParams, actors: Actors, before: Sensors | None = None) -> None:
        """before: other sensors; what they know of the same walls is taken over. Call `begin` before `sense`."""
        self._bounds = world.bounds  # of the first world, so that an edit does not change the scene numbers
        self._set_up(world, params, actors, before)

    def settle(self, world: World, params: SimParams, actors: Actors, before: Sensors | None = None) -> None:
        """Compute the caches from a world, a robot and the seed. before: as for new ones."""
        self._set_up(world, params, actors, before)
        if before is not None and before._seed == self._seed:
            self._camera.same_noise(before._camera)
        else:
            self._camera.new_noise(np.random.default_rng(seeds(self._seed)["noise bank"]))

    def _set_up(self, world: World, params: SimParams, actors: Actors, before: Sensors | None) -> None:
        self._angles = np.array(SONAR_ANGLES_RAD)
        self._world, self._actors = world, actors
        self._index()
        self._camera = Camera(world, params, actors, self._walls, None if before is None else before._camera)

    def begin(self, seed: int) -> None:
        """Begin all generators anew from this seed."""
        self._seed = seed
        chance = {owner: np.random.default_rng(own) for owner, own in seeds(seed).items()}
        self._image_rng, self._sonar_rng, self._odometry_rng = chance["image"], chance["sonar"], chance["odometry"]
        self._echo_rng, self._laser_rng = chance["echo"], chance["laser"]
        self._camera.new_noise(chance["noise bank"])

    def set_world(self, world: World, actors: Actors) -> None:
        """From now on sense another world, or the same one with other actors."""
        before, self._world, self._actors = self._world, world, actors
        if world is before:
            self._camera.follow(actors)
            return
        if world.walls != before.walls:
            self._index()
        self._camera.set_world(world, actors, self._walls)

    def set_lens(self, params: SimParams) -> None:
        """Set another field of view, resolution, height or fading of the camera."""
        self._camera.set_lens(params)

    def _index(self) -> None:
        """Build the indices of all walls, of those that echo, and of those that stop a laser."""
        world, segments = self._world, self._world.segments()
        opaque = [i for i in world.obstacles if world.walls[i].kind != "glass"]
        self._walls = build_index(segments)
        self._obstacles = build_index(segments[list(world.obstacles)])
        self._opaque = self._obstacles if len(opaque) == len(world.obstacles) else build_index(segments[opaque])

    def is_clear(self, x: float, y: float, reach: float) -> bool:
        """Whether no wall, door, box or person is within `reach` metres of (x, y)."""
        clear = is_clear(self._obstacles, self._actors.there, x, y, reach)
        return clear and not self._actors.walkers.touch(x, y, reach)

    def odometry(self, speed: float, yaw_rate: float, params: SimParams) -> tuple[float, float]:
        """What wheels and gyro report of a true motion (m/s, rad/s)."""
        return report(speed, yaw_rate, params, self._odometry_rng)

    def sense(
        self, tick: int, time_s: float, pose: Pose, odometry: tuple[float, float], params: SimParams, reflections: bool
    ) -> SensorFrame:
        """The sensor frame at a pose. Its arrays are read-only."""
        gain, noise = params.light * params.exposure_gain, params.image_noise * params.exposure_gain
        image = (
            self._camera.image(*pose, gain, noise, self._image_rng, reflections)
            if params.camera
            else np.zeros((params.image_height, params.image_width, 3), np.uint8)
        )
        ranges, bumped = self._sonar(pose, params)
        bumped = bumped or self._actors.walkers.touch(*pose[:2], params.robot_radius_m + params.bumper_m)
        scan = np.zeros(0, np.float32)
        if params.laser_beams:
            errors = self._laser_rng.standard_normal(params.laser_beams) * params.laser_noise_m
            fan = params.laser_fov_rad, params.laser_range_m
            scan = laser_ranges(self._opaque, self._actors.there, *pose, *fan, errors)
        scene = scene_number(*pose, self._bounds, params.scene_cell_m, params.scene_sector_rad)
        return SensorFrame(tick, time_s, image, *odometry, params.tick_s, ranges, bumped, scan, scene).freeze()

    def _sonar(self, pose: Pose, params: SimParams) -> tuple[NDArray[np.float32], bool]:
        n, radius = len(self._angles), params.robot_radius_m
        errors = self._sonar_rng.standard_normal(n) * params.sonar_noise_m
        ranges, bumped = sonar_ranges(
            self._obstacles, self._actors.there, *pose, self._angles, params.sonar_cone_rad, params.sonar_rays,
            params.sonar_range_m, errors, radius + params.bumper_m,
        )  # fmt: skip
        if params.sonar_false_echo > 0:
            chance = self._echo_rng.random((2, n))
            false = chance[0] < params.sonar_false_echo
            nowhere = radius + chance[1] * (params.sonar_range_m - radius)
            ranges = np.where(false, nowhere, ranges).astype(np.float32)
        return ranges, bumped

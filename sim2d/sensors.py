"""All sensors of the robot: camera, sonars, bumper, laser, wheels. Each has a generator of its own for its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from disk import kind
from sim2d.actors.actors import Actors
from sim2d.camera.camera import Camera
from sim2d.geometry.wall_index import WallIndex, build_index, crossing, first_wall, nearest_within, squared_distance
from sim2d.params import SimParams
from sim2d.world.world import World

Pose = tuple[float, float, float]  # x, y (m), heading (rad)
_OWNERS = ("image", "sonar", "odometry", "pose", "noise bank", "actors", "echo", "laser")
BUMPER_M = 0.005  # travel of the contact ring around the robot
# The floor and headings of one scene number. ACRA 2006 tells neither: a pose cell is 10 degrees wide, and its section 7 has
# several scenes for a place where matching is sensitive.
_SCENE_CELL_M, _SCENE_SECTOR_RAD = 0.5, math.radians(10)
_STILL_SPEED, _STILL_YAW_RATE = 1e-3, 2e-3  # m/s, rad/s: a robot slower than both gives no counts
_NOISE_S = 0.1  # `odometry_noise` is that of a movement of so long


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
        bumped = bumped or self._actors.walkers.touch(*pose[:2], params.robot_radius_m + BUMPER_M)
        scan = np.zeros(0, np.float32)
        if params.laser_beams:
            errors = self._laser_rng.standard_normal(params.laser_beams) * params.laser_noise_m
            fan = params.laser_fov_rad, params.laser_range_m
            scan = laser_ranges(self._opaque, self._actors.there, *pose, *fan, errors)
        scene = scene_number(*pose, self._bounds, _SCENE_CELL_M, _SCENE_SECTOR_RAD)
        return SensorFrame(tick, time_s, image, *odometry, params.tick_s, ranges, bumped, scan, scene).freeze()

    def _sonar(self, pose: Pose, params: SimParams) -> tuple[NDArray[np.float32], bool]:
        n, radius = len(self._angles), params.robot_radius_m
        errors = self._sonar_rng.standard_normal(n) * params.sonar_noise_m
        ranges, bumped = sonar_ranges(
            self._obstacles, self._actors.there, *pose, self._angles, params.sonar_cone_rad, params.sonar_rays,
            params.sonar_range_m, errors, radius + BUMPER_M,
        )  # fmt: skip
        if params.sonar_false_echo > 0:
            chance = self._echo_rng.random((2, n))
            false = chance[0] < params.sonar_false_echo
            nowhere = radius + chance[1] * (params.sonar_range_m - radius)
            ranges = np.where(false, nowhere, ranges).astype(np.float32)
        return ranges, bumped


def seeds(seed: int) -> dict[str, np.random.SeedSequence]:
    """A seed for each owner of random numbers in a simulator, so that none draws from another's stream."""
    return dict(zip(_OWNERS, np.random.SeedSequence(seed).spawn(len(_OWNERS)), strict=True))


def report(speed: float, yaw_rate: float, params: SimParams, rng: np.random.Generator) -> tuple[float, float]:
    """What wheel encoders and gyro report of a true motion: speed (m/s) and yaw rate (rad/s), with realistic errors.

    Makes two draws from `rng`, whether the robot moves or not. A robot at rest gives no counts and reports exactly (0, 0).
    The bias of the yaw rate acts only while the wheels turn, since a robot at rest could calibrate it away. The scale
    error comes from the wheels and affects only the speed.

    [ours] The noise of a short tick is larger, so that noise adds up to the same variance in a second at every rate.
    test_odometer.py::test_noise_adds_up_alike_at_every_rate.
    """
    speed_error, yaw_error = rng.standard_normal(2).tolist()
    noise = params.odometry_noise * math.sqrt(_NOISE_S / params.tick_s)
    if abs(speed) < _STILL_SPEED and abs(yaw_rate) < _STILL_YAW_RATE:
        return 0.0, 0.0
    return (
        speed * (1.0 + params.odometry_scale_error) * (1.0 + noise * speed_error),
        yaw_rate * (1.0 + noise * yaw_error) + params.gyro_bias,
    )


def true_motion(before: Pose, after: Pose, dt: float) -> tuple[float, float]:
    """Mean forward speed (m/s) and yaw rate (rad/s) between two poses that are `dt` seconds apart.

    The speed is that along the arc: the chord along the middle heading, divided by the sinc of half the turn.
    """
    turn = wrap_angle(after[2] - before[2])
    middle = before[2] + 0.5 * turn
    chord = (after[0] - before[0]) * math.cos(middle) + (after[1] - before[1]) * math.sin(middle)
    half = 0.5 * turn
    arc = chord * half / math.sin(half) if abs(half) > 1e-9 else chord
    return arc / dt, turn / dt


def wrap_angle(angle: float) -> float:
    """The same direction in (-pi, pi]."""
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


@njit(cache=True, nogil=True)
def scene_number(
    x: float, y: float, heading_rad: float, bounds: tuple[float, float, float, float], cell_m: float, angle_rad: float
) -> int:
    """A number from 0: equal for two poses in the same square of the floor and the same sector of heading, else different.

    As in the papers' own simulator: ACRA 2005 section 5, ACRA 2006 section 5.1. x, y (m) inside `bounds` (least x, least y,
    most x, most y). A sector is `angle_rad` wide, or a little less so that a whole number of them fits into a turn.
    """
    x_from, y_from, x_to, y_to = bounds
    columns, rows = max(1, math.ceil((x_to - x_from) / cell_m)), max(1, math.ceil((y_to - y_from) / cell_m))
    sectors = math.ceil(2 * math.pi / angle_rad - 1e-9)
    column = min(max(int((x - x_from) // cell_m), 0), columns - 1)
    row = min(max(int((y - y_from) // cell_m), 0), rows - 1)
    sector = int(heading_rad % (2 * math.pi) / (2 * math.pi) * sectors) % sectors
    return (sector * rows + row) * columns + column


# From left to right, as on the front of a Pioneer.
SONAR_ANGLES_RAD: tuple[float, ...] = tuple(math.radians(a) for a in (90, 50, 30, 10, -10, -30, -50, -90))

NO_ECHO_M = 5.0  # a sonar that hears nothing reports at least this, or a short one would have walls all around

_Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def sonar_ranges(
    index: WallIndex,
    elements: _Array,
    x: float,
    y: float,
    heading: float,
    angles: _Array,
    cone: float,
    rays: int,
    farthest: float,
    errors: _Array,
    touch: float,
) -> tuple[NDArray[np.float32], bool]:
    """(n,): distance (m) from the robot's middle to the nearest echo on the rays of each cone; NO_ECHO_M, or `farthest` if that
    is more, if there is none.

    Also returns whether anything is nearer than `touch` metres to the middle, in any direction.
    elements: (m, 4) sides of actors, besides the walls of the index. errors: (n,) added to each echo (m).
    """
    near = within(elements, x, y, farthest)
    out = np.empty(angles.size, np.float32)
    for i in range(angles.size):
        shortest = farthest
        for k in range(rays):
            angle = heading + angles[i] + cone * (k / (rays - 1) - 0.5)
            shortest = _range(index, near, x, y, angle, shortest)
        if shortest < farthest:
            shortest = max(shortest + errors[i], 0.0)
        out[i] = shortest if shortest < farthest else max(farthest, NO_ECHO_M)
    return out, not is_clear(index, near, x, y, touch)


@njit(cache=True, nogil=True)
def is_clear(index: WallIndex, elements: _Array, x: float, y: float, reach: float) -> bool:
    """Whether no wall of the index and none of the (m, 4) elements is nearer than `reach` metres to (x, y)."""
    for i in range(elements.shape[0]):
        if squared_distance(elements, i, x, y) < reach * reach:
            return False
    return nearest_within(index, x, y, reach) >= reach


@njit(cache=True, nogil=True)
def laser_ranges(
    index: WallIndex,
    elements: _Array,
    x: float,
    y: float,
    heading: float,
    fov: float,
    farthest: float,
    errors: _Array,
) -> NDArray[np.float32]:
    """(n,), from left to right: distance (m) to the first thing on each beam; `farthest` if there is none.

    index: of the walls that are not glass, since a laser passes through glass. errors: (n,) added to what is measured
    (m).
    """
    n = errors.size
    near = within(elements, x, y, farthest)
    step = fov / n if fov > 2.0 * math.pi - 1e-9 else fov / max(n - 1, 1)
    out = np.empty(n, np.float32)
    for i in range(n):
        length = _range(index, near, x, y, heading + 0.5 * fov - i * step, farthest)
        out[i] = min(max(length + errors[i], 0.0), farthest) if length < farthest else farthest
    return out


@njit(cache=True, nogil=True, inline="always")
def _range(index: WallIndex, near: _Array, x: float, y: float, angle: float, farthest: float) -> float:
    ux, uy = math.cos(angle), math.sin(angle)
    shortest = first_wall(index, x, y, ux, uy, farthest)[1]
    for i in range(near.shape[0]):
        shortest = min(shortest, crossing(near, i, x, y, ux, uy)[0])
    return shortest


@njit(cache=True, nogil=True)
def within(segments: _Array, x: float, y: float, reach: float) -> _Array:
    """Those of the (m, 4) segments whose bounding box is within `reach` metres of (x, y) in both axes."""
    out = np.empty_like(segments)
    n = 0
    for i in range(segments.shape[0]):
        if (
            min(segments[i, 0], segments[i, 2]) <= x + reach
            and max(segments[i, 0], segments[i, 2]) >= x - reach
            and min(segments[i, 1], segments[i, 3]) <= y + reach
            and max(segments[i, 1], segments[i, 3]) >= y - reach
        ):
            for k in range(4):
                out[n, k] = segments[i, k]
            n += 1
    return out[:n]

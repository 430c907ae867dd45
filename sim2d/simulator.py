"""The simulated robot in its office: drive commands in, what its sensors say out. It does not know that SLAM exists."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace

import numpy as np
import pymunk
from numpy.typing import NDArray

from sim2d.camera import Camera
from sim2d.free_space import FreeSpace
from sim2d.geometry import inside_ring, nearest_segment
from sim2d.living import Living
from sim2d.odometer import report, true_motion, wrap_angle
from sim2d.params import OfficeParams, SimParams
from sim2d.ranges import SONAR_ANGLES_RAD, is_clear, laser_ranges, sonar_ranges
from sim2d.robot import Robot
from sim2d.scenes import scene_number
from sim2d.solids import Solids
from sim2d.things import Box
from sim2d.wall_index import build_index
from sim2d.world import World
from sim2d.world_check import distance_to_box

BUMPER_M = 0.005  # travel of the contact ring around the robot
LEANS_M = 0.01  # so far the robot may press into something
FREE_M = 0.02  # what is farther away than the robot can come in a tick, and this, is out of its way


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
    laser_m: NDArray[np.float32]  # (laser_beams,) from the robot's middle, left to right over laser_fov_rad
    scene: int  # number of the true pose's square and sector, for brains that see only numbers, as in the papers


class Simulator:
    """One robot in one world; the only owner of its pymunk.Space. Use it from one thread."""

    def __init__(
        self, world: World, params: SimParams | None = None, seed: int = 0, office: OfficeParams | None = None,
        before: Simulator | None = None,
    ) -> None:  # fmt: skip
        """before: another one, whose work on the same walls need not be done again; nothing else of it is looked at."""
        self.world = self._first_world = world
        self.params, self.office = params or SimParams(), office or OfficeParams()
        self._angles = np.array(SONAR_ANGLES_RAD)
        self._measured: FreeSpace | None = None if before is None else before._measured
        self._measure()
        self._bounds = world.bounds  # of the first world: the numbers of its scenes stay when walls are edited
        refusal = self.free_space.refusal(world.starts[0].x, world.starts[0].y)
        if refusal is not None:
            raise ValueError(f"{world.name}: the robot cannot start at {world.starts[0].name}: {refusal}")
        living = Living(world, np.random.default_rng(0), self.params.tick_s)
        self._camera = Camera(world, self.params, living, self._all_walls, None if before is None else before._camera)
        self._painted = world
        self.reset(seed)

    def _measure(self) -> None:
        """Where the robot fits, and the indices of the walls that sensors meet."""
        self.free_space = self.free_in(self.world)
        self._index()

    def _index(self) -> None:
        world = self.world
        segments = world.segments()
        opaque = [i for i in world.obstacles if world.walls[i].kind != "glass"]
        self._all_walls = build_index(segments)
        self._obstacles = build_index(segments[list(world.obstacles)])
        self._opaque = self._obstacles if len(opaque) == len(world.obstacles) else build_index(segments[opaque])

    def reset(self, seed: int) -> None:
        """Begin anew at the first start pose. Same seed and same calls afterwards: the same frames, bit for bit."""
        (
            self._image_rng, self._sonar_rng, self._odometry_rng, self._pose_rng, bank_rng, living_rng, self._echo_rng,
            self._laser_rng,
        ) = (np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(8))  # fmt: skip
        self._camera.new_noise(bank_rng)
        if self.world is not self._first_world:
            self.world = self._first_world
            self._measure()
        if self.office.seed:
            living_rng = np.random.default_rng(self.office.seed)
        self.living = Living(self.world, living_rng, self.params.tick_s)
        if self._painted is self.world:
            self._camera.follow(self.living)
        else:
            self._camera.set_world(self.world, self.living, self._all_walls)
            self._painted = self.world
        self._space = pymunk.Space()
        self._space.collision_slop = 0.001  # metres of overlap that the solver leaves alone; pymunk's own is for pixels
        self._solids = Solids(self._space, self.world, self.living)
        start = self.world.starts[0]
        self._robot = Robot(self._space, self.params, start.x, start.y, start.heading_rad)
        self._begin_here()
        self._tick = 0
        self._clock = (0, 0.0)  # tick and time at which the present rate of ticks began
        self._motion = (0.0, 0.0)
        self._frame = self._sense(0.0, 0.0)

    @property
    def truth(self) -> Truth:
        """The true pose and motion."""
        x, y, heading = self._robot.pose
        return Truth(x, y, wrap_angle(heading), *self._motion)

    def observe(self) -> SensorFrame:
        """What was sensed last: at the start, after the last step or after a teleport. Nothing advances."""
        return self._frame

    def step(self, drive: Drive) -> SensorFrame:
        """Drive for one tick, then sense."""
        before, params = self._robot.pose, self.params
        here = before[:2]
        self._tick += 1
        self.living.step(self._time_s, here, params.robot_radius_m, params.max_speed * params.tick_s, self.office)
        self._solids.follow(here)
        is_free = self._is_clear(*here, self._robot.reach(params) + FREE_M)
        self._robot.drive(self._space, drive.speed, drive.yaw_rate, params, self._slowness(*here), is_free)
        self._motion = true_motion(before, self._robot.pose, params.tick_s)
        self._frame = self._sense(*report(*self._motion, self.params, self._odometry_rng))
        return self._frame

    def teleport(self, x: float, y: float, heading_rad: float) -> None:
        """Put the robot elsewhere, at rest; its encoders do not notice.

        ValueError with the reason when it cannot be there: outside, in a wall (which, how far), closed in, not finite.
        """
        if not math.isfinite(heading_rad):
            raise ValueError(f"heading must be finite, got {heading_rad}")
        refusal = self.free_space.refusal(x, y) or self.living.refusal(x, y, self.params.robot_radius_m)
        if refusal is not None:
            raise ValueError(refusal)
        self._robot.place(x, y, heading_rad)
        self._space.reindex_shapes_for_body(self._robot.body)
        self._solids.follow((x, y))
        self._motion = (0.0, 0.0)
        self._frame = self._sense(0.0, 0.0)

    def random_free_pose(self) -> tuple[float, float, float]:
        """A pose on free floor, from the simulator's own generator: x, y, heading in (-pi, pi]."""
        x, y = self.free_space.random_point(self._pose_rng)
        return x, y, wrap_angle(float(self._pose_rng.uniform(-math.pi, math.pi)))

    def free_in(self, world: World) -> FreeSpace:
        """Where the robot would fit in a world; what that has in common with the last one is not measured again."""
        if self._measured is None or not self._measured.holds(world, self.params.robot_radius_m):
            self._measured = FreeSpace(world, self.params.robot_radius_m, before=self._measured)
        return self._measured

    # ------------------------------------------------------------ changes; ValueError says why one cannot be

    def set_params(self, params: SimParams) -> None:
        """Go on with these from the next tick on. ValueError when the robot has grown and has no room where it is."""
        before = self.params
        if params.robot_radius_m > before.robot_radius_m:
            self._require_room(params.robot_radius_m)
        self._clock, self.params = (self._tick, self._time_s), params
        if params.sensor_rate_hz != before.sensor_rate_hz:
            self.living.set_tick(params.tick_s)
        if params.robot_radius_m != before.robot_radius_m:
            self._robot.resize(self._space, params.robot_radius_m)
            self._measure()
        lens = ("camera_fov_rad", "image_width", "image_height", "camera_height_m")
        if any(getattr(params, name) != getattr(before, name) for name in lens):
            self._camera.set_lens(params)

    def _require_room(self, radius: float) -> None:
        x, y, _ = self._robot.pose
        refusal = _covered(self.world, x, y, radius) or self.living.refusal(x, y, radius - LEANS_M)
        if refusal is not None:
            raise ValueError(f"robot_radius_m cannot become {radius:g} here: {refusal}")

    def set_door(self, name: str, is_open: bool) -> None:
        """Open or shut a door. It moves from the next tick on, and waits for who stands in it."""
        self.living.set_door(name, is_open)

    def set_lamp(self, name: str, on: bool) -> None:
        """Switch a lamp."""
        self.living.set_lamp(name, on)

    def put_box(self, box: Box) -> None:
        """Put a new box down; refused where it would cover the robot or outside."""
        if any(other.name == box.name for other in self.world.boxes):
            raise ValueError(f"there is a box named {box.name!r} already; remove it first or use another name")
        if not inside_ring(self.world.outline, box.x, box.y):
            x0, y0, x1, y1 = self.world.bounds
            raise ValueError(
                f"({box.x:g}, {box.y:g}) is outside of {self.world.name}, which spans {x0:g} to {x1:g} by {y0:g} to {y1:g} m"
            )
        self.set_world(replace(self.world, boxes=(*self.world.boxes, box)))

    def remove_box(self, name: str) -> None:
        """Take a box away for good."""
        names = [box.name for box in self.world.boxes]
        if name not in names:
            raise ValueError(
                f"no box named {name!r}; expected one of: {', '.join(names) or 'none, since there are none'}"
            )
        self.set_world(replace(self.world, boxes=tuple(box for box in self.world.boxes if box.name != name)))

    def set_world(self, world: World) -> None:
        """Go on in an edited world: robot, time and whatever kept its name stay as they are. `reset` undoes it.

        world: as `check_world` lets it pass. Refused when a wall or thing would cover the robot or leave it outside.
        """
        x, y, _ = self._robot.pose
        radius = self.params.robot_radius_m
        refusal = _covered(world, x, y, radius) or self.living.leaf_on(world.doors, x, y, radius - LEANS_M)
        if refusal is not None:
            raise ValueError(refusal)
        walls_stay = world.walls == self.world.walls
        before, self.world = self.living, world
        self.free_space = self.free_in(world)
        if not walls_stay:
            self._index()
        self.living = Living(world, np.random.default_rng(self._pose_rng.integers(2**63)), self.params.tick_s)
        self.living.adopt(before)
        self.living.make_way((x, y), radius)
        self._camera.set_world(world, self.living, self._all_walls)
        self._painted = world
        self._solids.furnish(world, self.living)
        self._begin_here()

    def state(self) -> bytes:
        """Digest of everything that decides the future: equal histories give equal digests."""
        body = self._robot.body
        numbers = [*self._robot.pose, *body.velocity, body.angular_velocity, self._robot.speed, self._robot.yaw_rate]
        digest = hashlib.sha256(np.array([self._tick, self._time_s, *self._motion, *numbers], np.float64).tobytes())
        generators = (
            self._image_rng,
            self._sonar_rng,
            self._odometry_rng,
            self._pose_rng,
            self._echo_rng,
            self._laser_rng,
        )
        for rng in generators:
            digest.update(repr(rng.bit_generator.state).encode())
        digest.update(self._frame.image.tobytes())
        digest.update(repr((self.params, self.office)).encode())
        digest.update(self.living.state())
        return digest.digest()

    @property
    def _time_s(self) -> float:
        tick, time_s = self._clock
        return time_s + (self._tick - tick) / self.params.sensor_rate_hz

    def _begin_here(self) -> None:
        x, y, _ = self._robot.pose
        self.living.begin(self.office)
        self.living.make_way((x, y), self.params.robot_radius_m)
        self._solids.follow((x, y))

    def _is_clear(self, x: float, y: float, reach: float) -> bool:
        """Whether no wall, thing or person is within `reach`."""
        clear = is_clear(self._obstacles, self.living.there, x, y, reach)
        return clear and not self.living.walkers.touch(x, y, reach)

    def _slowness(self, x: float, y: float) -> float:
        """The share of the wheels' speed that the floor lets through: the slowest of the zones that (x, y) is in."""
        if not self.office.slow_zones:
            return 1.0
        factors = [z.factor for z in self.world.slow_zones if inside_ring(np.array(z.corners, np.float64), x, y)]
        return min(factors, default=1.0)

    def _sense(self, speed: float, yaw_rate: float) -> SensorFrame:
        params, living = self.params, self.living
        x, y, heading = self._robot.pose
        gain, noise = params.light * params.exposure_gain, params.image_noise * params.exposure_gain
        image = self._camera.image(x, y, heading, gain, noise, self._image_rng, self.office.reflections)
        ranges, bumped = self._sonar(living.there, x, y, heading)
        bumped = bumped or living.walkers.touch(x, y, params.robot_radius_m + BUMPER_M)
        scan = np.zeros(0, np.float32)
        if params.laser_beams:
            errors = self._laser_rng.standard_normal(params.laser_beams) * params.laser_noise_m
            pose = (x, y, heading)
            scan = laser_ranges(self._opaque, living.there, *pose, params.laser_fov_rad, params.laser_range_m, errors)
        for array in (image, ranges, scan):
            array.setflags(write=False)
        scene = scene_number(x, y, heading, self._bounds, params.scene_cell_m, params.scene_sector_rad)
        return SensorFrame(
            self._tick, self._time_s, image, speed, yaw_rate, params.tick_s, ranges,
            bumped, scan, scene,
        )  # fmt: skip

    def _sonar(
        self, things: NDArray[np.float64], x: float, y: float, heading: float
    ) -> tuple[NDArray[np.float32], bool]:
        params, n = self.params, len(SONAR_ANGLES_RAD)
        errors = self._sonar_rng.standard_normal(n) * params.sonar_noise_m
        ranges, bumped = sonar_ranges(
            self._obstacles, things, x, y, heading, self._angles, params.sonar_cone_rad, params.sonar_range_m, errors,
            params.robot_radius_m + BUMPER_M,
        )  # fmt: skip
        if params.sonar_false_echo > 0:
            chance = self._echo_rng.random((2, n))
            false = chance[0] < params.sonar_false_echo
            nowhere = params.robot_radius_m + chance[1] * (params.sonar_range_m - params.robot_radius_m)
            ranges = np.where(false, nowhere, ranges).astype(np.float32)
        return ranges, bumped


def _covered(world: World, x: float, y: float, radius: float) -> str | None:
    """Why a robot that is at (x, y) could not stay there in another world, or None."""
    at = f"the robot at ({x:.2f}, {y:.2f})"
    if not inside_ring(world.outline, x, y):
        return f"{at} would be outside of the outer walls; leave it inside"
    radius -= LEANS_M
    nearest, distance = nearest_segment(world.segments()[list(world.obstacles)], x, y)
    if distance < radius:
        i = world.obstacles[nearest]
        return f"walls[{i}] ({world.walls[i].kind}) would cover {at}; keep {radius:.2f} m away from it"
    for box in world.boxes:
        if box.present and distance_to_box(box, x, y) < radius:
            return f"box {box.name!r} would cover {at}; keep {radius:.2f} m away from it"
    return None

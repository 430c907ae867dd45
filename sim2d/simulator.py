"""The simulated robot in its office: drive commands in, sensor readings out. It does not know that SLAM exists."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace

import numpy as np

from disk import encode, kind
from sim2d.actors.actors import Actors
from sim2d.geometry.segments import inside_ring
from sim2d.params import OfficeParams, SimParams
from sim2d.robot import Robot, Surroundings
from sim2d.sensors import SensorFrame, Sensors, seeds, true_motion, wrap_angle
from sim2d.world.free_space import FreeSpace, RobotFit
from sim2d.world.world import BOX_M, Box, World

_TRIES = 1000  # random places tried to find one where the robot fits
_OF_BOXES = ("box_appear", "box_vanish")  # lines of the script
FREE_M = 0.02  # margin added to how far the robot can come in a tick, when deciding whether it may touch anything


@dataclass(frozen=True, slots=True)
class Drive:
    """A command for one tick: speed in m/s, positive forwards; yaw rate in rad/s, positive counter-clockwise.

    Both are limited to what the robot can do.
    """

    speed: float
    yaw_rate: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.speed) and math.isfinite(self.yaw_rate)):
            raise ValueError(f"a drive must be finite, got speed {self.speed}, yaw_rate {self.yaw_rate}")


@dataclass(frozen=True, slots=True)
class Truth:
    """Where the robot really is (m, rad, office frame), for judging and drawing, never for the robot."""

    x: float
    y: float
    heading_rad: float
    speed: float  # mean over the last tick
    yaw_rate: float


@kind("simulator/1")
class Simulator:
    """One robot in one world. Use it from one thread."""

    CACHES = ("world", "_first_world", "_measured", "free_space", "_surroundings")

    def __init__(
        self, world: World, params: SimParams | None = None, seed: int = 0, office: OfficeParams | None = None,
        before: Simulator | None = None,
    ) -> None:  # fmt: skip
        """before: another simulator; what it has computed from the same walls is taken over, and nothing else."""
        self.params, self.office = params or SimParams(), office or OfficeParams()
        self.actors = Actors(world, np.random.default_rng(0), self.params.tick_s, self.office)
        self._sensors = Sensors(world, self.params, self.actors, None if before is None else before._sensors)
        self._begin_in(world, None if before is None else before._measured)
        self.actors.begin(self.office)
        start = world.starts[0]
        self.actors.make_way((start.x, start.y), self.params.robot_radius_m)
        refusal = self.fit.refusal(start.x, start.y)
        if refusal is not None:
            raise ValueError(f"{world.name}: the robot cannot start at {start.name}: {refusal}")
        self.reset(seed)

    def settle(self, world: World, before: Simulator | None = None) -> None:
        """Compute the caches anew in a simulator that was restored from a state. `reset` then begins in this world.

        before: another one, as for a new simulator.
        """
        self.actors.settle(world)
        self._sensors.settle(world, self.params, self.actors, None if before is None else before._sensors)
        self._begin_in(world, None if before is None else before._measured)
        self._frame.freeze()

    def _begin_in(self, world: World, measured: FreeSpace | None) -> None:
        self.world = self._first_world = world
        self._measured = measured
        self.free_space = self.free_in(world)
        self._surroundings = Surroundings(world, self.actors)

    def reset(self, seed: int) -> None:
        """Begin anew at the first start pose. The same seed and the same calls give the same frames, bit for bit."""
        self._sensors.begin(seed)
        chance = seeds(seed)
        self._pose_rng = np.random.default_rng(chance["pose"])
        self.world = self._first_world
        self.free_space = self.free_in(self.world)
        actors_rng = np.random.default_rng(self.office.seed or chance["actors"])
        self.actors = Actors(self.world, actors_rng, self.params.tick_s, self.office)
        self._sensors.set_world(self.world, self.actors)
        start = self.world.starts[0]
        self._robot = Robot((start.x, start.y, start.heading_rad))
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
        """The last sensor frame: from the start, the last step or a teleport. Time does not advance."""
        return self._frame

    def step(self, drive: Drive) -> SensorFrame:
        """Drive for one tick, then sense."""
        before, params = self._robot.pose, self.params
        here = before[:2]
        self._tick += 1
        self.actors.step(self._time_s, here, params.robot_radius_m, params.max_speed * params.tick_s, self.office)
        reach = self._robot.reach(params) + FREE_M
        clear = self._sensors.is_clear(*here, reach)
        space = None if clear else self._surroundings.space(*here, reach, params.friction)
        self._robot.drive(drive.speed, drive.yaw_rate, params, self._slowness(*here), space)
        self._motion = true_motion(before, self._robot.pose, params.tick_s)
        self._frame = self._sense(*self._sensors.odometry(*self._motion, params))
        return self._frame

    def teleport(self, x: float, y: float, heading_rad: float) -> None:
        """Put the robot elsewhere, at rest. Its encoders do not notice.

        ValueError says why, if the robot does not fit there (`RobotFit`) or the heading is not finite.
        """
        if not math.isfinite(heading_rad):
            raise ValueError(f"heading must be finite, got {heading_rad}")
        refusal = self.fit.refusal(x, y)
        if refusal is not None:
            raise ValueError(refusal)
        self._robot = Robot((float(x), float(y), float(heading_rad)))
        self._motion = (0.0, 0.0)
        self._frame = self._sense(0.0, 0.0)

    def random_free_pose(self) -> tuple[float, float, float]:
        """A random pose where the robot fits now, from the simulator's own generator: x, y, heading in (-pi, pi]."""
        fit = self.fit
        for _ in range(_TRIES):
            x, y = self.free_space.random_point(self._pose_rng)
            heading = wrap_angle(float(self._pose_rng.uniform(-math.pi, math.pi)))
            if fit.refusal(x, y) is None:
                return x, y, heading
        raise ValueError(f"doors, boxes and people leave the robot no room: all {_TRIES} random places tried are taken")

    @property
    def fit(self) -> RobotFit:
        """Where the robot fits at this moment."""
        return RobotFit(self.free_space, self.actors.standing())

    def free_in(self, world: World, radius: float | None = None) -> FreeSpace:
        """The floor that a world's walls leave free. Only what differs from the last one is measured anew."""
        radius = self.params.robot_radius_m if radius is None else radius
        if self._measured is None or not self._measured.holds(world, radius):
            self._measured = FreeSpace(world, radius, before=self._measured)
        return self._measured

    # ------------------------------------------------------------ changes; ValueError says why one cannot be made

    def set_params(self, params: SimParams) -> None:
        """Go on with these from the next tick on. ValueError if the robot would grow and has no room where it is."""
        before = self.params
        if params.robot_radius_m > before.robot_radius_m:
            self._require_room(params.robot_radius_m)
        self._clock, self.params = (self._tick, self._time_s), params
        if params.sensor_rate_hz != before.sensor_rate_hz:
            self.actors.set_tick(params.tick_s)
        if params.robot_radius_m != before.robot_radius_m:
            self.free_space = self.free_in(self.world)
        lens = ("camera_fov_rad", "image_width", "image_height", "camera_height_m", "fade_m")
        if any(getattr(params, name) != getattr(before, name) for name in lens):
            self._sensors.set_lens(params)

    def _require_room(self, radius: float) -> None:
        x, y, _ = self._robot.pose
        refusal = RobotFit(self.free_in(self.world, radius), self.actors.standing()).covering(x, y)
        if refusal is not None:
            raise ValueError(f"robot_radius_m cannot become {radius:g} here: {refusal}")

    def set_door(self, name: str, is_open: bool) -> None:
        """Open or shut a door. It moves from the next tick on and waits for anybody in its way."""
        self.actors.set_door(name, is_open)

    def set_lamp(self, name: str, on: bool) -> None:
        """Switch a lamp."""
        self.actors.set_lamp(name, on)

    def put_box(self, box: Box) -> None:
        """Put a new box down. ValueError if it would cover the robot or is outside."""
        if any(other.name == box.name for other in self.world.boxes):
            raise ValueError(f"there is a box named {box.name!r} already; remove it first or use another name")
        for name, edge_m in (("width", box.width), ("depth", box.depth), ("height", box.height)):
            if not BOX_M[0] <= edge_m <= BOX_M[1]:
                raise ValueError(f"the {name} of a box must be {BOX_M[0]:g} to {BOX_M[1]:g} m, got {edge_m:g}")
        if not math.isfinite(box.angle_rad):
            raise ValueError(f"the angle of a box must be finite, got {box.angle_rad:g}")
        if not inside_ring(self.world.outline, box.x, box.y):
            x0, y0, x1, y1 = self.world.bounds
            raise ValueError(
                f"({box.x:g}, {box.y:g}) is outside of {self.world.name}, which spans {x0:g} to {x1:g} by {y0:g} to {y1:g} m"
            )
        as_in_a_file = replace(box, angle_rad=math.radians(math.degrees(box.angle_rad)))  # files hold degrees
        self.set_world(replace(self.world, boxes=(*self.world.boxes, as_in_a_file)))

    def remove_box(self, name: str) -> None:
        """Take a box away for good, with the lines of the script that move it."""
        names = [box.name for box in self.world.boxes]
        if name not in names:
            raise ValueError(
                f"no box named {name!r}; expected one of: {', '.join(names) or 'none, since there are none'}"
            )
        boxes = tuple(box for box in self.world.boxes if box.name != name)
        script = tuple(event for event in self.world.script if not (event.do in _OF_BOXES and event.name == name))
        self.set_world(replace(self.world, boxes=boxes, script=script))

    def set_world(self, world: World) -> None:
        """Go on in an edited world. Robot, time and everything that kept its name stay as they are. `reset` undoes it.

        world: one that `check_world` accepts. ValueError if something would cover the robot or leave it outside; people
        make way.
        """
        pose_rng = copy.deepcopy(self._pose_rng)  # a refused edit must not advance the generator
        actors_rng = np.random.default_rng(pose_rng.integers(2**63))
        actors = Actors(world, actors_rng, self.params.tick_s, self.office)
        actors.adopt(self.actors)
        actors.begin(self.office)
        free_space = self.free_in(world)
        x, y, _ = self._robot.pose
        actors.make_way((x, y), self.params.robot_radius_m)
        refusal = RobotFit(free_space, actors.standing()).covering(x, y)
        if refusal is not None:
            raise ValueError(refusal)
        self.world, self.free_space, self.actors, self._pose_rng = world, free_space, actors, pose_rng
        self._sensors.set_world(world, self.actors)
        self._begin_here()

    def digest(self) -> str:
        """SHA-256 of everything that decides the future in this world. Equal histories have equal digests."""
        return encode(self).digest()

    @property
    def _time_s(self) -> float:
        tick, time_s = self._clock
        return time_s + (self._tick - tick) / self.params.sensor_rate_hz

    def _begin_here(self) -> None:
        x, y, _ = self._robot.pose
        self.actors.begin(self.office)
        self.actors.make_way((x, y), self.params.robot_radius_m)
        self._surroundings = Surroundings(self.world, self.actors)

    def _slowness(self, x: float, y: float) -> float:
        """The share of the wheels' speed that the floor at (x, y) lets through: the least of the zones there, or 1."""
        if not (self.office.slow_zones and self.world.slow_zones):
            return 1.0
        factors = [z.factor for z in self.world.slow_zones if inside_ring(np.array(z.corners, np.float64), x, y)]
        return min(factors, default=1.0)

    def _sense(self, speed: float, yaw_rate: float) -> SensorFrame:
        x, y, heading = self._robot.pose
        here = self._tick, self._time_s, (x, y, heading)
        return self._sensors.sense(*here, (speed, yaw_rate), self.params, self.office.reflections)

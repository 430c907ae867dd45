"""What is true of the simulated robot and office between two ticks."""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import FAR_M, array, number, true, whole, within
from sim2d import OfficeParams, SensorFrame, SimParams, Simulator, World
from sim2d.actors.actors import Actors
from sim2d.actors.walkers import Walkers
from sim2d.importers.empty_room import empty_room

LONGEST_S = 1e12
FASTEST = 1e3  # m/s and rad/s
MOST_TURNED = 1e9  # rad: headings are not wrapped


def simulator(simulator: Simulator, world: World) -> None:
    """ValueError names the first law that does not hold. world: the world that the robot is in."""
    true(isinstance(simulator, Simulator), f"its simulator is a {type(simulator).__name__}")
    same_kind("parameters", simulator.params, SimParams())
    same_kind("office", simulator.office, OfficeParams())
    fresh = Simulator(empty_room("laws", "laws", 4.0, 4.0), simulator.params, 0, simulator.office)
    same_kind("simulator", simulator, fresh)
    whole("tick", simulator._tick)
    whole("the tick at which the rate changed", simulator._clock[0], 0, simulator._tick)
    number("the time at which the rate changed", simulator._clock[1], 0.0, LONGEST_S)
    _robot(simulator, world)
    _actors(simulator.actors, world, simulator.params.tick_s)
    whole("the sensors' seed", simulator._sensors._seed, 0, 2**64)
    x0, y0, x1, y1 = (number("a bound", bound, -FAR_M, FAR_M) for bound in simulator._sensors._bounds)
    true(x0 < x1 and y0 < y1, "the bounds must be from the least to the most")
    _frame(simulator._frame)


def _robot(simulator: Simulator, world: World) -> None:
    robot, (x0, y0, x1, y1) = simulator._robot, world.bounds
    number("the robot's x", robot.pose[0], x0, x1)
    number("the robot's y", robot.pose[1], y0, y1)
    number("the robot's heading", robot.pose[2], -MOST_TURNED, MOST_TURNED)
    for speed in (*robot.velocity, robot.spin, robot.speed, robot.yaw_rate, *simulator._motion):
        number("a speed of the robot", speed, -FASTEST, FASTEST)


def _actors(actors: Actors, world: World, tick_s: float) -> None:
    doors, boxes, lamps = len(world.doors), len(world.boxes), len(world.lamps)
    for name in ("opening", "_wanted"):
        within(f"doors: {name}", array(f"doors: {name}", getattr(actors, name), np.float64, (doors,)), 0.0, 1.0)
    automatic = actors._automatic
    true(
        len(automatic) == doors and all(known is None or isinstance(known, bool) for known in automatic),
        f"doors: what they did by themselves must be known or not of all {doors}",
    )
    array("boxes", actors.box_present, np.bool_, (boxes,))
    array("boxes that are to come", actors._box_wanted, np.bool_, (boxes,))
    array("lamps", actors.lamp_on, np.bool_, (lamps,))
    number("daylight", actors.daylight, 0.0, FAR_M)
    if actors._level is not None:
        number("the script's daylight", actors._level, 0.0, FAR_M)
    whole("the next line of the script", actors._next, 0, len(world.script))
    number("the actors' time", actors._time_s, -1.0, LONGEST_S)
    for owner in (actors._tick_s, actors.walkers.tick_s):
        true(owner == tick_s, f"a tick must last {tick_s:g} s, got {owner:g}")
    _walkers(actors.walkers, world)


def _walkers(walkers: Walkers, world: World) -> None:
    n, x = len(world.people), np.array([len(person.path) for person in world.people], np.int64)
    x0, y0, x1, y1 = world.bounds
    xy = array("people", walkers.xy, np.float64, (n, 2))
    within("people: x", xy[:, 0], x0, x1)
    within("people: y", xy[:, 1], y0, y1)
    within("people: heading", array("people: heading", walkers.heading, np.float64, (n,)), -MOST_TURNED, MOST_TURNED)
    towards = array("people: where to", walkers._towards, np.int64, (n,))
    within("people: where to", towards, 0, np.iinfo(np.int64).max)
    true((towards < x).all(), "people must walk to a point of their path")
    way = array("people: way", walkers._way, np.int64, (n,))
    true((np.abs(way) == 1).all(), "people must walk forth or back")
    for name in ("_waits", "_patience"):
        values = array(f"people: {name[1:]}", getattr(walkers, name), np.float64, (n,))
        within(f"people: {name[1:]}", values, -LONGEST_S, LONGEST_S)
    array("people: present", walkers.present, np.bool_, (n,))
    within("people: numbers drawn", array("people: numbers drawn", walkers._drawn, np.int64, (n,)), 0, 2**53)
    bank = Walkers(world.people[:1], np.random.default_rng(0), 0.1, 0.0)._chance.shape[1]
    within("people: chance", array("people: chance", walkers._chance, np.float64, (n, bank)), 0.0, 1.0)


def _frame(frame: SensorFrame) -> None:
    whole("the frame's tick", frame.tick)
    number("the frame's time", frame.time_s, 0.0, LONGEST_S)
    number("the frame's length", frame.dt, 1e-6, LONGEST_S)
    array("the image", frame.image, np.uint8, (None, None, 3))
    ranges = array("the sonars", frame.ranges_m, np.float32, (8,))
    within("the sonars", ranges, -FAR_M, FAR_M)
    within("the laser", frame.laser_m, -FAR_M, FAR_M)
    for speed in (frame.odometry_speed, frame.odometry_yaw_rate):
        number("a speed that the odometry says", speed, -FASTEST, FASTEST)
    whole("the scene", frame.scene)

"""What the robot can run into in one tick, in pymunk: the walls, door leaves, boxes and people around it.

The robot's body: a disc on two driven wheels, in pymunk.

A kinematic body, the wheels, moves as commanded. A pivot and a gear with bounded force drag the disc along. At a wall
the force is not enough, and the disc stops there; setting the disc's velocity instead would press it 10 cm into the
wall. On free floor the disc goes where the wheels roll, and pymunk is not needed, as long as the wheels grip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pymunk
from numba import njit
from pymunk.constraints import GearJoint, PivotJoint

from disk import kind
from sim2d.actors.actors import Actors
from sim2d.params import SimParams
from sim2d.world.world import World

_MARGIN_M = 0.1  # more than the solver can push the robot beyond its reach


class Surroundings:
    """Makes the pymunk space of a tick.

    [ours] Every tick in which the robot may touch something gets a new space, with everything near in the world's
    order. A space kept over several ticks would hold contacts and impulses that cannot be read or set. With a new one,
    only the robot's pose and speeds go from tick to tick, and a saved session goes on bit for bit even while the robot
    touches a wall (test_session_snapshot.py). Most ticks need no space; making one costs a tenth of a millisecond.
    """

    def __init__(self, world: World, actors: Actors) -> None:
        self._walls = world.segments()[list(world.obstacles)].reshape(-1, 2, 2)
        self._actors = actors

    def space(self, x: float, y: float, reach: float, friction: float) -> pymunk.Space:
        """A space with everything within `reach` metres of (x, y), and little more. All of it has this friction."""
        space = pymunk.Space()
        space.collision_slop = 0.001  # overlap (m) that the solver tolerates; pymunk's default is meant for pixels
        low, high = np.subtract((x, y), reach + _MARGIN_M), np.add((x, y), reach + _MARGIN_M)
        near = (self._walls.max(axis=1) >= low) & (self._walls.min(axis=1) <= high)
        ground, actors = space.static_body, self._actors
        leaves = actors.segments[: actors.first_box]
        standing, shapes = actors.standing(), list[pymunk.Shape]()
        for x1, y1, x2, y2 in (*self._walls[near.all(axis=1)].reshape(-1, 4).tolist(), *leaves.tolist()):
            shapes.append(pymunk.Segment(ground, (x1, y1), (x2, y2), 0.0))
        for box in standing.boxes:
            shapes.append(pymunk.Poly(ground, box.corners.tolist()))
        for _, px, py, radius in standing.people:
            if max(abs(px - x), abs(py - y)) < radius + reach + _MARGIN_M:
                shapes.append(pymunk.Circle(ground, radius, (px, py)))
        for shape in shapes:
            shape.friction = friction
        space.add(*shapes)
        return space


Pose = tuple[float, float, float]
_STEPS_PER_COMMAND = 4  # the motor controller runs at a quarter of the physics rate: setting velocities is slow


@kind("robot/1")
@dataclass(slots=True)
class Robot:
    """The whole state of the body between two ticks. Poses in metres and radians, office frame."""

    pose: Pose  # at the end of the last tick; the heading is not wrapped
    velocity: tuple[float, float] = (0.0, 0.0)  # of the disc, m/s, office frame
    spin: float = 0.0  # of the disc, rad/s
    speed: float = 0.0  # of the wheels, m/s, positive forwards
    yaw_rate: float = 0.0  # of the wheels, rad/s, positive counter-clockwise

    def drive(
        self, speed: float, yaw_rate: float, params: SimParams, slowness: float, space: pymunk.Space | None = None
    ) -> None:
        """Drive for one tick. The motors change the wheels' velocities towards these (m/s, rad/s) as fast as they can.

        slowness: the share of both velocities that the floor lets through, so that curves keep their shape.
        space: holds everything that the disc could touch in this tick; None: nothing is so near.
        """
        speed = slowness * min(max(speed, -params.max_speed), params.max_speed)
        yaw_rate = slowness * min(max(yaw_rate, -params.max_yaw_rate), params.max_yaw_rate)
        dt = 1.0 / params.physics_rate_hz
        period = _STEPS_PER_COMMAND * dt
        motors = speed, yaw_rate, params.max_acceleration * period, params.max_yaw_acceleration * period
        if space is None and not _grips(params):
            space = pymunk.Space()
        if space is not None:
            self._push(space, motors, params, dt)
            return
        x, y, angle, v, w = _rolled(*self.pose, self.speed, self.yaw_rate, *motors, params.substeps, dt)
        self.pose, self.speed, self.yaw_rate = (x, y, angle), v, w
        self.velocity, self.spin = (v * math.cos(angle), v * math.sin(angle)), w

    def _push(
        self, space: pymunk.Space, motors: tuple[float, float, float, float], params: SimParams, dt: float
    ) -> None:
        """Drive near obstacles or on wheels that may slip: they drag the disc along, and pymunk lets it collide."""
        body, wheels = self._put_into(space, params)
        period, v, w = _STEPS_PER_COMMAND * dt, self.speed, self.yaw_rate
        for first in range(0, params.substeps, _STEPS_PER_COMMAND):
            v, w = _commanded(v, w, *motors)
            middle = body.angle + 0.5 * w * period
            wheels.velocity, wheels.angular_velocity = (v * math.cos(middle), v * math.sin(middle)), w
            for _ in range(first, min(first + _STEPS_PER_COMMAND, params.substeps)):
                space.step(dt)
        (x, y), (vx, vy) = body.position, body.velocity
        self.pose, self.speed, self.yaw_rate = (x, y, body.angle), v, w
        self.velocity, self.spin = (vx, vy), body.angular_velocity

    def _put_into(self, space: pymunk.Space, params: SimParams) -> tuple[pymunk.Body, pymunk.Body]:
        """Put the disc into the space, and the wheels that drag it. Nothing stops the wheels."""
        radius, mass = params.robot_radius_m, params.mass_kg
        body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0.0, radius))
        disc = pymunk.Circle(body, radius)
        disc.friction = params.friction
        wheels = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        pivot = PivotJoint(wheels, body, (0.0, 0.0), (0.0, 0.0))
        gear = GearJoint(wheels, body, 0.0, 1.0)
        pivot.max_bias = gear.max_bias = 0.0  # the joints pass on velocities only, never positions
        pivot.max_force, gear.max_force = params.grip_n, params.turn_grip_nm
        space.add(body, disc, wheels, pivot, gear)
        body.position, body.angle = self.pose[:2], self.pose[2]
        body.velocity, body.angular_velocity = self.velocity, self.spin
        return body, wheels

    def reach(self, params: SimParams) -> float:
        """How far (m) from its middle at the start of a tick any part of the disc may come within the tick."""
        slides = math.hypot(*self.velocity)  # on wheels that slip, faster than they roll
        fastest = max(params.max_speed, abs(self.speed), slides)
        return params.robot_radius_m + fastest * params.tick_s


def _grips(params: SimParams) -> bool:
    """Whether the wheels pass on all that the motors can ask for, on the straight and in a curve."""
    force = params.mass_kg * math.hypot(params.max_acceleration, params.max_speed * params.max_yaw_rate)
    torque = _inertia(params.mass_kg, params.robot_radius_m) * params.max_yaw_acceleration
    return force <= params.grip_n and torque <= params.turn_grip_nm


@lru_cache(maxsize=1)
def _inertia(mass_kg: float, radius_m: float) -> float:
    """Of the disc, kg m²: asked in every tick, and the same as long as nobody changes the robot."""
    return pymunk.moment_for_circle(mass_kg, 0.0, radius_m)


@njit(cache=True, nogil=True)
def _commanded(
    v: float, w: float, speed: float, yaw_rate: float, change: float, turn_change: float
) -> tuple[float, float]:
    """The wheels' speed and yaw rate after one command of the motor controller, whose change is limited."""
    return v + min(max(speed - v, -change), change), w + min(max(yaw_rate - w, -turn_change), turn_change)


@njit(cache=True, nogil=True)
def _rolled(
    x: float,
    y: float,
    angle: float,
    v: float,
    w: float,
    speed: float,
    yaw_rate: float,
    change: float,
    turn_change: float,
    substeps: int,
    dt: float,
) -> tuple[float, float, float, float, float]:
    """Pose, speed and yaw rate after a tick with nothing in the way."""
    for first in range(0, substeps, _STEPS_PER_COMMAND):
        v, w = _commanded(v, w, speed, yaw_rate, change, turn_change)
        seconds = min(_STEPS_PER_COMMAND, substeps - first) * dt
        middle = angle + 0.5 * w * seconds  # the chord's direction: exact to 3e-5 at full turn
        x, y, angle = x + v * seconds * math.cos(middle), y + v * seconds * math.sin(middle), angle + w * seconds
    return x, y, angle, v, w

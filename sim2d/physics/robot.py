"""The robot's body: a disc on two driven wheels, in pymunk.

A kinematic body moves as the wheels are told; a pivot and a gear with bounded force drag the disc along. Against a wall
the force gives way and the disc stops there. Setting the disc's velocity would press it 10 cm into the wall. On free floor
there is nothing to give way to: the disc goes where the wheels roll, and pymunk is not asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymunk
from numba import njit
from pymunk.constraints import GearJoint, PivotJoint

from disk import kind
from sim2d.params import SimParams

_MASS_KG = 8.0
_GRIP_N = 80.0  # the wheels slip beyond it: 10 m/s^2, far above what the motors ask for
_GRIP_NM = 20.0
_FRICTION = 0.3
Pose = tuple[float, float, float]
_STEPS_PER_COMMAND = 4  # the motor controller runs at a quarter of the physics rate: setting velocities is what costs


@kind("robot/1")
@dataclass(slots=True)
class Robot:
    """Owned by one simulator. Poses in metres and radians. It is all that a tick leaves to the next."""

    pose: Pose  # as of the last tick; its heading is not wrapped
    velocity: tuple[float, float] = (0.0, 0.0)  # of the disc, m/s, office frame
    spin: float = 0.0  # of the disc, rad/s
    speed: float = 0.0  # what the wheels do now, m/s
    yaw_rate: float = 0.0  # rad/s

    def drive(
        self, speed: float, yaw_rate: float, params: SimParams, slowness: float, space: pymunk.Space | None = None
    ) -> None:
        """One tick towards these velocities (m/s, rad/s), as fast as the motors can change them.

        slowness: the share of them that the floor lets through; of both, so that curves keep their shape. space: with what the
        disc could touch in this tick; None: nothing is so near.
        """
        speed = slowness * min(max(speed, -params.max_speed), params.max_speed)
        yaw_rate = slowness * min(max(yaw_rate, -params.max_yaw_rate), params.max_yaw_rate)
        dt = 1.0 / params.physics_rate_hz
        period = _STEPS_PER_COMMAND * dt
        motors = speed, yaw_rate, params.max_acceleration * period, params.max_yaw_acceleration * period
        if space is not None:
            self._push(space, motors, params, dt)
            return
        x, y, angle, v, w = _rolled(*self.pose, self.speed, self.yaw_rate, *motors, params.substeps, dt)
        self.pose, self.speed, self.yaw_rate = (x, y, angle), v, w
        self.velocity, self.spin = (v * math.cos(angle), v * math.sin(angle)), w

    def _push(
        self, space: pymunk.Space, motors: tuple[float, float, float, float], params: SimParams, dt: float
    ) -> None:
        """The disc among what it can touch, dragged along by the wheels."""
        body, wheels = self._put_into(space, params.robot_radius_m)
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

    def _put_into(self, space: pymunk.Space, radius: float) -> tuple[pymunk.Body, pymunk.Body]:
        """The disc and, dragging it, the wheels, which nothing stops."""
        body = pymunk.Body(_MASS_KG, pymunk.moment_for_circle(_MASS_KG, 0.0, radius))
        disc = pymunk.Circle(body, radius)
        disc.friction = _FRICTION
        wheels = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        pivot = PivotJoint(wheels, body, (0.0, 0.0), (0.0, 0.0))
        gear = GearJoint(wheels, body, 0.0, 1.0)
        pivot.max_bias = gear.max_bias = 0.0  # only velocities are passed on, never positions
        pivot.max_force, gear.max_force = _GRIP_N, _GRIP_NM
        space.add(body, disc, wheels, pivot, gear)
        body.position, body.angle = self.pose[:2], self.pose[2]
        body.velocity, body.angular_velocity = self.velocity, self.spin
        return body, wheels

    def reach(self, params: SimParams) -> float:
        """How far (m) from its middle the disc may come within a tick."""
        return params.robot_radius_m + max(params.max_speed, abs(self.speed)) * params.tick_s


@njit(cache=True, nogil=True)
def _commanded(
    v: float, w: float, speed: float, yaw_rate: float, change: float, turn_change: float
) -> tuple[float, float]:
    """What the motors make of the wheels' speeds with one command."""
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
    """Where the wheels roll within a tick with nothing in their way, and how fast they turn then."""
    for first in range(0, substeps, _STEPS_PER_COMMAND):
        v, w = _commanded(v, w, speed, yaw_rate, change, turn_change)
        seconds = min(_STEPS_PER_COMMAND, substeps - first) * dt
        middle = angle + 0.5 * w * seconds  # the chord's direction: exact to 3e-5 at full turn
        x, y, angle = x + v * seconds * math.cos(middle), y + v * seconds * math.sin(middle), angle + w * seconds
    return x, y, angle, v, w

"""The robot's body: a disc on two driven wheels, in pymunk.

A kinematic body moves as the wheels are told; a pivot and a gear with bounded force drag the disc along. Against a wall
the force gives way and the disc stops there. Setting the disc's velocity would press it 10 cm into the wall. On free floor
there is nothing to give way to: the disc goes where the wheels roll, and pymunk is not asked.
"""

from __future__ import annotations

import math

import pymunk
from numba import njit
from pymunk.constraints import GearJoint, PivotJoint

from sim2d.params import SimParams

_MASS_KG = 8.0
_GRIP_N = 80.0  # the wheels slip beyond it: 10 m/s^2, far above what the motors ask for
_GRIP_NM = 20.0
_STEPS_PER_COMMAND = 4  # the motor controller runs at a quarter of the physics rate: setting velocities is what costs


class Robot:
    """Owned by one simulator. Poses in metres and radians."""

    def __init__(self, space: pymunk.Space, params: SimParams, x: float, y: float, heading_rad: float) -> None:
        radius = params.robot_radius_m
        self.body = pymunk.Body(_MASS_KG, pymunk.moment_for_circle(_MASS_KG, 0.0, radius))
        self._disc = disc = pymunk.Circle(self.body, radius)
        disc.friction = 0.3
        self._wheels = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        pivot = PivotJoint(self._wheels, self.body, (0.0, 0.0), (0.0, 0.0))
        gear = GearJoint(self._wheels, self.body, 0.0, 1.0)
        pivot.max_bias = gear.max_bias = 0.0  # only velocities are passed on, never positions
        pivot.max_force, gear.max_force = _GRIP_N, _GRIP_NM
        space.add(self.body, disc, self._wheels, pivot, gear)
        self.pose = (x, y, heading_rad)  # the body's, as of the last tick; its heading is not wrapped
        self.speed = 0.0  # what the wheels do now, m/s
        self.yaw_rate = 0.0  # rad/s
        self.place(x, y, heading_rad)

    def resize(self, space: pymunk.Space, radius: float) -> None:
        """Another radius; whether there is room for it is the caller's business."""
        self._disc.unsafe_set_radius(radius)
        self.body.moment = pymunk.moment_for_circle(_MASS_KG, 0.0, radius)
        space.reindex_shapes_for_body(self.body)

    def place(self, x: float, y: float, heading_rad: float) -> None:
        """Put down at rest."""
        self.body.position = (x, y)
        self.body.angle = heading_rad
        self.body.velocity = self._wheels.velocity = (0.0, 0.0)
        self.body.angular_velocity = self._wheels.angular_velocity = 0.0
        self.speed = self.yaw_rate = 0.0
        self.pose = (float(x), float(y), float(heading_rad))

    def drive(
        self, space: pymunk.Space, speed: float, yaw_rate: float, params: SimParams, slowness: float, is_free: bool
    ) -> None:
        """One tick towards these velocities (m/s, rad/s), as fast as the motors can change them.

        slowness: the share of them that the floor lets through; of both, so that curves keep their shape. is_free: nothing
        is so near that the disc could touch it in this tick.
        """
        speed = slowness * min(max(speed, -params.max_speed), params.max_speed)
        yaw_rate = slowness * min(max(yaw_rate, -params.max_yaw_rate), params.max_yaw_rate)
        dt = 1.0 / params.physics_rate_hz
        period = _STEPS_PER_COMMAND * dt
        motors = speed, yaw_rate, params.max_acceleration * period, params.max_yaw_acceleration * period
        body, wheels = self.body, self._wheels
        if is_free:
            x, y, angle, v, w = _rolled(*self.pose, self.speed, self.yaw_rate, *motors, params.substeps, dt)
            body.position, body.angle = (x, y), angle
            body.velocity, body.angular_velocity = (v * math.cos(angle), v * math.sin(angle)), w
        else:
            v, w = self.speed, self.yaw_rate
            for first in range(0, params.substeps, _STEPS_PER_COMMAND):
                v, w = _commanded(v, w, *motors)
                middle = body.angle + 0.5 * w * period
                wheels.velocity, wheels.angular_velocity = (v * math.cos(middle), v * math.sin(middle)), w
                for _ in range(first, min(first + _STEPS_PER_COMMAND, params.substeps)):
                    space.step(dt)
            (x, y), angle = body.position, body.angle
        self.pose, self.speed, self.yaw_rate = (x, y, angle), v, w

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

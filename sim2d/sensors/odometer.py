"""What wheel encoders and gyro report: the true motion of a tick, with realistic errors."""

from __future__ import annotations

import math

import numpy as np

from sim2d.params import SimParams

_NOISE_S = 0.1  # `odometry_noise` is that of a movement of so long


def wrap_angle(angle: float) -> float:
    """The same direction in (-pi, pi]."""
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def true_motion(
    before: tuple[float, float, float], after: tuple[float, float, float], dt: float
) -> tuple[float, float]:
    """Mean forward speed (m/s) and yaw rate (rad/s) between two poses (x, y, heading) that are `dt` seconds apart.

    The speed is that along the arc: the chord along the middle heading, divided by the sinc of half the turn.
    """
    turn = wrap_angle(after[2] - before[2])
    middle = before[2] + 0.5 * turn
    chord = (after[0] - before[0]) * math.cos(middle) + (after[1] - before[1]) * math.sin(middle)
    half = 0.5 * turn
    arc = chord * half / math.sin(half) if abs(half) > 1e-9 else chord
    return arc / dt, turn / dt


def report(speed: float, yaw_rate: float, params: SimParams, rng: np.random.Generator) -> tuple[float, float]:
    """Reported speed (m/s) and yaw rate (rad/s). Makes two draws from `rng`, whether the robot moves or not.

    A robot at rest gives no counts and reports exactly (0, 0). The bias of the yaw rate acts only while the wheels
    turn, since a robot at rest could calibrate it away. The scale error comes from the wheels and affects only the
    speed.

    [ours] The noise of a short tick is larger, so that noise adds up to the same variance in a second at every rate.
    test_odometer.py::test_noise_adds_up_alike_at_every_rate.
    """
    speed_error, yaw_error = rng.standard_normal(2).tolist()
    noise = params.odometry_noise * math.sqrt(_NOISE_S / params.tick_s)
    if abs(speed) < params.still_speed and abs(yaw_rate) < params.still_yaw_rate:
        return 0.0, 0.0
    return (
        speed * (1.0 + params.odometry_scale_error) * (1.0 + noise * speed_error),
        yaw_rate * (1.0 + noise * yaw_error) + params.gyro_bias,
    )

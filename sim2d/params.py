"""The simulator's numbers, each declared once: symbol, unit, source, range, meaning, and whether it may change live."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any


def _number(
    default: float,
    low: float,
    high: float,
    symbol: str,
    unit: str,
    meaning: str,
    source: str = "ours",
    live: bool = False,
) -> Any:
    metadata = {
        "symbol": symbol,
        "unit": unit,
        "source": source,
        "low": low,
        "high": high,
        "meaning": meaning,
        "choices": (),
        "live": live,
    }
    return field(default=default, metadata=metadata)


@dataclass(frozen=True, slots=True, kw_only=True)
class SimParams:
    """Robot, camera, sonar and odometry of one simulation. A number out of its range raises ValueError."""

    physics_rate_hz: int = _number(
        240, 60, 2000, "f_p", "Hz", "physics sub-steps a second; a multiple of the sensor rate"
    )
    sensor_rate_hz: int = _number(
        10, 1, 60, "f_s", "Hz", "ticks a second: camera, sonar, encoders, one command", "ACRA 2005"
    )

    robot_radius_m: float = _number(0.22, 0.05, 0.5, "r", "m", "radius of the round robot", "Pioneer 2-DXE")
    max_speed: float = _number(0.5, 0.05, 2.0, "v_max", "m/s", "fastest drive, forwards and backwards", live=True)
    max_yaw_rate: float = _number(math.pi / 2, 0.1, 2 * math.pi, "w_max", "rad/s", "fastest turn", live=True)
    max_acceleration: float = _number(
        1.0, 0.05, 10.0, "a_max", "m/s^2", "the motors' limit on change of speed", live=True
    )
    max_yaw_acceleration: float = _number(
        6.0, 0.1, 60.0, "alpha_max", "rad/s^2", "the motors' limit on change of yaw rate", live=True
    )

    camera_fov_rad: float = _number(math.radians(50), 0.2, 2.4, "phi", "rad", "horizontal field of view", "ACRA 2006")
    image_width: int = _number(64, 8, 640, "W", "px", "columns of the camera image")
    image_height: int = _number(48, 8, 480, "H", "px", "rows of the camera image; pixels are square")
    camera_height_m: float = _number(0.45, 0.1, 1.5, "h", "m", "height of the camera above the floor")
    image_noise: float = _number(
        1.0, 0.0, 50.0, "sigma_I", "grey levels", "random error of each pixel's channel", live=True
    )
    light: float = _number(1.0, 0.1, 2.0, "L", "1", "brightness of the lamps", live=True)

    sonar_range_m: float = _number(5.0, 0.5, 20.0, "d_max", "m", "farthest echo; what a sonar says when there is none")
    sonar_noise_m: float = _number(0.02, 0.0, 0.5, "sigma_d", "m", "random error of an echo", live=True)

    odometry_noise: float = _number(
        0.05, 0.0, 0.5, "sigma_o", "1", "random error of speed and yaw rate, a tick", live=True
    )
    odometry_scale_error: float = _number(
        0.02, -0.5, 0.5, "k_v", "1", "reported over true distance, less one: a wheel's diameter taken wrong", live=True
    )
    gyro_bias: float = _number(
        math.radians(0.2),
        -0.2,
        0.2,
        "b_w",
        "rad/s",
        "added to the yaw rate while the wheels turn",
        "ACRA 2005",
        live=True,
    )

    def __post_init__(self) -> None:
        for item in fields(self):
            _check(item.name, getattr(self, item.name), item.type, item.metadata["low"], item.metadata["high"])
        if self.physics_rate_hz % self.sensor_rate_hz:
            raise ValueError(
                f"physics_rate_hz must be a multiple of sensor_rate_hz ({self.sensor_rate_hz}), "
                f"got {self.physics_rate_hz}"
            )

    @property
    def tick_s(self) -> float:
        """Duration of one tick, seconds."""
        return 1.0 / self.sensor_rate_hz

    @property
    def substeps(self) -> int:
        """Physics sub-steps in one tick."""
        return self.physics_rate_hz // self.sensor_rate_hz


def _check(name: str, value: object, kind: object, low: float, high: float) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"{name} must be a number from {low:g} to {high:g}, got {value!r}")
    if kind == "int" and not isinstance(value, int):
        raise ValueError(f"{name} must be a whole number from {low:g} to {high:g}, got {value!r}")
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low:g} to {high:g}, got {value!r}")

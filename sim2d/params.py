"""The simulator's parameters, each declared once: symbol, unit, source, range, meaning, whether it may change live."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

from disk import kind


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
    return field(default=default, metadata=_about(symbol, unit, source, low, high, meaning, live))


def _switch(default: bool, meaning: str, source: str = "ours") -> Any:
    return field(default=default, metadata=_about("", "", source, None, None, meaning, True))


def _about(
    symbol: str,
    unit: str,
    source: str,
    low: float | None,
    high: float | None,
    meaning: str,
    live: bool,
) -> dict[str, Any]:
    return {
        "symbol": symbol,
        "unit": unit,
        "source": source,
        "low": low,
        "high": high,
        "meaning": meaning,
        "choices": (),
        "live": live,
    }


@kind("parameters of robot/3")
@dataclass(frozen=True, slots=True, kw_only=True)
class SimParams:
    """Robot, camera, sonar, laser and odometry of one simulation. A value out of its range raises ValueError."""

    physics_rate_hz: int = _number(
        240, 60, 2000, "f_p", "Hz", "physics sub-steps per second; a multiple of the sensor rate", live=True
    )
    sensor_rate_hz: int = _number(
        10,
        1,
        60,
        "f_s",
        "Hz",
        "ticks per second; each tick has one command, one image, one reading of every sensor",
        "ACRA 2005",
        live=True,
    )

    robot_radius_m: float = _number(0.22, 0.05, 0.5, "r", "m", "radius of the round robot", "Pioneer 2-DXE", live=True)
    max_speed: float = _number(0.5, 0.05, 2.0, "v_max", "m/s", "fastest drive, forwards and backwards", live=True)
    max_yaw_rate: float = _number(math.pi / 2, 0.1, 2 * math.pi, "w_max", "rad/s", "fastest turn", live=True)
    max_acceleration: float = _number(
        1.0, 0.05, 10.0, "a_max", "m/s^2", "the motors' limit on change of speed", live=True
    )
    max_yaw_acceleration: float = _number(
        6.0, 0.1, 60.0, "alpha_max", "rad/s^2", "the motors' limit on change of yaw rate", live=True
    )
    mass_kg: float = _number(8.0, 1.0, 100.0, "m", "kg", "mass of the robot, the same all over its disc", live=True)
    grip_n: float = _number(80.0, 1.0, 1000.0, "F_g", "N", "the wheels slip rather than pass on more force", live=True)
    turn_grip_nm: float = _number(
        20.0, 0.1, 200.0, "tau_g", "N m", "the wheels slip rather than pass on more torque in a turn", live=True
    )
    friction: float = _number(
        0.3, 0.0, 1.0, "mu", "1", "friction of the robot's rim and of all that it touches; their product is Coulomb's",
        live=True,
    )  # fmt: skip

    camera: bool = _switch(True, "the camera sees; off = its image is black, for brains that see only numbers")
    camera_fov_rad: float = _number(
        math.radians(50),
        0.2,
        2 * math.pi,
        "phi",
        "rad",
        "horizontal field of view; above 2.4 a panorama",
        "ACRA 2006",
        live=True,
    )
    image_width: int = _number(64, 8, 640, "W", "px", "columns of the camera image", live=True)
    image_height: int = _number(48, 8, 480, "H", "px", "rows of the camera image; pixels are square", live=True)
    camera_height_m: float = _number(0.45, 0.1, 1.5, "h", "m", "height of the camera above the floor", live=True)
    image_noise: float = _number(
        1.0,
        0.0,
        50.0,
        "sigma_I",
        "grey levels",
        "standard deviation of the noise on each colour channel of a pixel",
        live=True,
    )
    exposure_gain: float = _number(
        1.0, 0.1, 8.0, "g", "1", "gain of the camera, applied to image and noise alike", live=True
    )
    light: float = _number(1.0, 0.1, 2.0, "L", "1", "overall brightness of the image; 1 = as painted", live=True)
    fade_m: float = _number(
        14.0,
        0.5,
        1000.0,
        "d_f",
        "m",
        "what is this deep in the image is half as bright: 1 / (1 + depth / fade)",
        live=True,
    )

    scene_cell_m: float = _number(
        0.5,
        0.1,
        10.0,
        "",
        "m",
        "side of the floor squares that have one scene number each",
        "ACRA 2005, 2006; value ours",
    )
    scene_sector_rad: float = _number(
        math.radians(30),
        0.05,
        2 * math.pi,
        "",
        "rad",
        "width of the heading sectors that have one scene number each",
        "ACRA 2005, 2006; value ours",
    )

    sonar_range_m: float = _number(
        5.0, 0.5, 20.0, "d_max", "m", "farthest echo; also what a sonar reports when there is none", live=True
    )
    sonar_cone_rad: float = _number(
        math.radians(15),
        0.0,
        1.0,
        "beta",
        "rad",
        "opening angle of a sonar's cone; the nearest echo within it counts",
        live=True,
    )
    sonar_rays: int = _number(5, 2, 61, "n_d", "1", "rays that each cone is searched with", live=True)
    sonar_noise_m: float = _number(
        0.02, 0.0, 0.5, "sigma_d", "m", "standard deviation of the error of an echo", live=True
    )
    sonar_false_echo: float = _number(
        0.0, 0.0, 1.0, "p_e", "1", "share of readings that are false, at a random distance", live=True
    )

    bumper_m: float = _number(0.005, 0.0, 0.1, "", "m", "travel of the contact ring around the robot", live=True)

    laser_beams: int = _number(
        0, 0, 1081, "n_l", "1", "beams of the laser, evenly spread over its field of view; 0 = no laser", "ACRA 2005",
        live=True,
    )  # fmt: skip
    laser_fov_rad: float = _number(
        math.pi, 0.1, 2 * math.pi, "phi_l", "rad", "field of view of the laser", "ACRA 2005", live=True
    )
    laser_range_m: float = _number(8.0, 0.5, 80.0, "l_max", "m", "farthest distance that the laser measures", live=True)
    laser_noise_m: float = _number(
        0.01, 0.0, 0.5, "sigma_l", "m", "standard deviation of the error of a beam", live=True
    )

    odometry_noise: float = _number(
        0.05,
        0.0,
        0.5,
        "sigma_o",
        "1",
        "standard deviation of the relative error of speed and yaw rate in 0.1 s; it adds up like noise",
        live=True,
    )
    odometry_scale_error: float = _number(
        0.02, -0.5, 0.5, "k_v", "1", "reported distance over true distance, minus 1: a wrong wheel diameter", live=True
    )
    still_speed: float = _number(
        1e-3, 0.0, 0.1, "", "m/s", "a robot slower than this, and than `still_yaw_rate`, gives no counts", live=True
    )
    still_yaw_rate: float = _number(
        2e-3,
        0.0,
        0.1,
        "",
        "rad/s",
        "a robot that turns more slowly than this, and is slower than `still_speed`, gives no counts",
        live=True,
    )
    gyro_bias: float = _number(
        math.radians(0.2), -0.2, 0.2, "b_w", "rad/s", "added to the yaw rate while the wheels turn: 0.0035 = 0.2 deg/s",
        "ACRA 2005", live=True,
    )  # fmt: skip

    def __post_init__(self) -> None:
        _check(self)
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


@kind("parameters of office/2")
@dataclass(frozen=True, slots=True, kw_only=True)
class OfficeParams:
    """Which parts of the office are active, and how its doors and people move."""

    people: bool = _switch(True, "people walk about; off = nobody is there", "ACRA 2004")
    doors: bool = _switch(True, "doors with a period open and shut by themselves", "ACRA 2004")
    lamps: bool = _switch(True, "lamps that are on shine; off = all are dark", "ACRA 2004")
    daylight: bool = _switch(True, "daylight changes with time; off = it stays as at the start", "ACRA 2004")
    reflections: bool = _switch(
        True, "glass reflects what is in front of it; off = it only shows its own colour", "ACRA 2004"
    )
    door_s: float = _number(1.5, 0.1, 60.0, "", "s", "time that a door takes to open or shut", live=True)
    door_tip_m: float = _number(  # at most as far as the smallest robot is wide
        0.1,
        0.01,
        0.1,
        "",
        "m",
        "a leaf's tip moves no farther in a tick, so that it cannot jump over the robot",
        live=True,
    )
    patience_least_s: float = _number(
        3.0, 0.0, 600.0, "", "s", "how long a person stands at an obstacle before turning back, at least ...", live=True
    )
    patience_most_s: float = _number(8.0, 0.0, 600.0, "", "s", "... and at most; each time is random", live=True)
    slow_zones: bool = _switch(True, "slow floors slow the robot down", "IROS 2005")
    boxes: bool = _switch(True, "boxes stand on the floor; off = all are taken away")
    script: bool = _switch(True, "the world's script is carried out")
    seed: int = _number(0, 0, 2**32 - 1, "", "", "seed for the people; 0 = derived from the seed of the run")

    def __post_init__(self) -> None:
        _check(self)
        if self.patience_least_s > self.patience_most_s:
            least, most = self.patience_least_s, self.patience_most_s
            raise ValueError(f"patience_least_s must be at most patience_most_s ({most:g}), got {least:g}")


def _check(params: Any) -> None:
    """ValueError for the first value out of range or of a wrong type; it says what would be right."""
    for item in fields(params):
        name, value, about = item.name, getattr(params, item.name), item.metadata
        if isinstance(item.default, bool):
            if not isinstance(value, bool):
                raise ValueError(f"{name} must be true or false, got {value!r}")
        else:
            _check_number(name, value, isinstance(item.default, int), about["low"], about["high"])


def _check_number(name: str, value: object, whole: bool, low: float, high: float) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"{name} must be a number from {low:g} to {high:g}, got {value!r}")
    if whole and not isinstance(value, int):
        raise ValueError(f"{name} must be a whole number from {low:g} to {high:g}, got {value!r}")
    if not low <= value <= high:
        raise ValueError(f"{name} must be from {low:g} to {high:g}, got {value!r}")

"""The simulator's parameters, each declared once."""

from __future__ import annotations

import math
from dataclasses import dataclass

from disk import kind
from disk.parameter import check_ranges, param

# Tables: the formatter would give each number a line
# fmt: off


@kind("parameters of robot/4")
@dataclass(frozen=True, slots=True, kw_only=True)
class SimParams:
    """Robot, camera, sonar, laser and odometry of one simulation. A value out of its range raises ValueError."""

    physics_rate_hz: int = param(
        240, "physics sub-steps per second; a multiple of the sensor rate", 60, 2000, "Hz", symbol="f_p")
    sensor_rate_hz: int = param(
        10, "ticks per second; each tick has one command, one image, one reading of every sensor", 1, 60, "Hz",
        symbol="f_s", source="ACRA 2005")
    robot_radius_m: float = param(0.22, "radius of the round robot", 0.05, 0.5, "m", symbol="r", source="Pioneer 2-DXE")
    max_speed: float = param(0.5, "fastest drive, forwards and backwards", 0.05, 2.0, "m/s", symbol="v_max")
    max_yaw_rate: float = param(math.pi / 2, "fastest turn", 0.1, 2 * math.pi, "rad/s", symbol="ω_max")
    max_acceleration: float = param(1.0, "the motors' limit on change of speed", 0.05, 10.0, "m/s^2", symbol="a_max")
    max_yaw_acceleration: float = param(
        6.0, "the motors' limit on change of yaw rate", 0.1, 60.0, "rad/s^2", symbol="α_max")
    mass_kg: float = param(8.0, "mass of the robot, a uniform disc", 1.0, 100.0, "kg", symbol="m")
    grip_n: float = param(80.0, "force above which the wheels slip", 1.0, 1000.0, "N", symbol="F_g")
    turn_grip_nm: float = param(
        20.0, "torque above which the wheels slip in a turn", 0.1, 200.0, "N m", symbol="τ_g")
    friction: float = param(
        0.3, "friction of the robot's rim and of all that it touches; their product is Coulomb's", 0.0, 1.0, symbol="μ")
    camera: bool = param(True, "the camera sees; off = its image is black, for brains that see only numbers")
    camera_fov_rad: float = param(
        math.radians(50), "horizontal field of view; above 2.4 a panorama", 0.2, 2 * math.pi, "rad", symbol="φ",
        source="ACRA 2006")
    image_width: int = param(64, "columns of the camera image", 8, 640, "px", symbol="W")
    image_height: int = param(48, "rows of the camera image; pixels are square", 8, 480, "px", symbol="H")
    camera_height_m: float = param(0.45, "height of the camera above the floor", 0.1, 1.5, "m", symbol="h")
    image_noise: float = param(
        1.0, "standard deviation of the noise on each colour channel of a pixel", 0.0, 50.0, "grey levels", symbol="σ_I")
    exposure_gain: float = param(1.0, "gain of the camera, applied to image and noise alike", 0.1, 8.0, symbol="g")
    light: float = param(1.0, "overall brightness of the image; 1 = as painted", 0.1, 2.0, symbol="L")
    fade_m: float = param(
        14.0, "what is this deep in the image is half as bright: 1 / (1 + depth / fade)", 0.5, 1000.0, "m", symbol="d_f")
    sonar_range_m: float = param(
        5.0, "farthest echo; a sonar that hears none reports this, but no less than 5 m", 0.5, 20.0, "m", symbol="d_max")
    sonar_cone_rad: float = param(
        math.radians(15), "opening angle of a sonar's cone; the nearest echo within it counts", 0.0, 1.0, "rad",
        symbol="β")
    sonar_rays: int = param(5, "rays that each cone is searched with", 2, 61, symbol="n_d")
    sonar_noise_m: float = param(0.02, "standard deviation of the error of an echo", 0.0, 0.5, "m", symbol="σ_d")
    sonar_false_echo: float = param(
        0.0, "share of readings that are false, at a random distance", 0.0, 1.0, symbol="p_e")
    laser_beams: int = param(
        0, "beams of the laser, evenly spread over its field of view; 0 = no laser", 0, 1081, symbol="n_l",
        source="ACRA 2005")
    laser_fov_rad: float = param(
        math.pi, "field of view of the laser", 0.1, 2 * math.pi, "rad", symbol="φ_l", source="ACRA 2005")
    laser_range_m: float = param(8.0, "farthest distance that the laser measures", 0.5, 80.0, "m", symbol="l_max")
    laser_noise_m: float = param(0.01, "standard deviation of the error of a beam", 0.0, 0.5, "m", symbol="σ_l")
    odometry_noise: float = param(
        0.05, "standard deviation of the relative error of speed and yaw rate in 0.1 s; it adds up like noise", 0.0, 0.5,
        symbol="σ_o")
    odometry_scale_error: float = param(
        0.02, "reported distance over true distance, minus 1: a wrong wheel diameter", -0.5, 0.5, symbol="k_v",
        lecture=True)
    gyro_bias: float = param(
        math.radians(0.2), "added to the yaw rate while the wheels turn: 0.0035 = 0.2 deg/s", -0.2, 0.2, "rad/s",
        symbol="b_ω", source="ACRA 2005", lecture=True)

    def __post_init__(self) -> None:
        check_ranges(self)
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


@kind("parameters of office/3")
@dataclass(frozen=True, slots=True, kw_only=True)
class OfficeParams:
    """Which parts of the office are active, and how its doors and people move."""

    people: bool = param(True, "people walk about; off = nobody is there", source="ACRA 2004")
    doors: bool = param(True, "doors with a period open and shut by themselves", source="ACRA 2004")
    lamps: bool = param(True, "lamps that are on shine; off = all are dark", source="ACRA 2004")
    daylight: bool = param(True, "daylight changes with time; off = it stays as at the start", source="ACRA 2004")
    reflections: bool = param(
        True, "glass reflects what is in front of it; off = it only shows its own colour", source="ACRA 2004")
    door_s: float = param(1.5, "time that a door takes to open or shut", 0.1, 60.0, "s")
    patience_least_s: float = param(
        3.0, "least time that a person waits at an obstacle before turning back", 0.0, 600.0, "s")
    patience_most_s: float = param(8.0, "longest such time; each is random", 0.0, 600.0, "s")
    slow_zones: bool = param(True, "slow floors slow the robot down", source="IROS 2005")
    boxes: bool = param(True, "boxes stand on the floor; off = all are taken away")
    script: bool = param(True, "timed changes of the world file happen; off = none")
    seed: int = param(0, "seed for the people; 0 = derived from the seed of the run", 0, 2**32 - 1, live=False)

    def __post_init__(self) -> None:
        check_ranges(self)
        if self.patience_least_s > self.patience_most_s:
            least, most = self.patience_least_s, self.patience_most_s
            raise ValueError(f"patience_least_s must be at most patience_most_s ({most:g}), got {least:g}")

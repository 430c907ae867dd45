"""Named settings: the engine of each paper, our own, and two robots. A preset changes only the parameters it names."""

from __future__ import annotations

import math

from app.config.tree import Config, Value
from ratslam_core.params.presets import PRESETS as ENGINES

ROBOTS: dict[str, dict[str, Value]] = {
    # ACRA 2004, section 5; ACRA 2005, section 4; IROS 2005: Pioneer 2-DXE, 50 degrees, 0.5 m/s, 90 deg/s, 10 Hz
    "Pioneer 2DXE 2004": {
        "robot.robot_radius_m": 0.22,
        "robot.max_speed": 0.5,
        "robot.max_yaw_rate": math.pi / 2,
        "robot.camera_fov_rad": math.radians(50),
        "robot.image_width": 64,
        "robot.image_height": 48,
        "robot.image_noise": 2.0,
        "robot.exposure_gain": 1.0,
        "robot.sonar_range_m": 5.0,
        "robot.sonar_cone_rad": math.radians(15),
        "robot.sonar_noise_m": 0.02,
        "robot.sonar_false_echo": 0.01,
        "robot.laser_beams": 181,
        "robot.laser_fov_rad": math.pi,
        "robot.laser_range_m": 8.0,
        "robot.laser_noise_m": 0.01,
        "robot.odometry_noise": 0.05,
        "robot.odometry_scale_error": 0.02,
        "robot.gyro_bias": math.radians(0.5),
    },
    "ideal": {
        "robot.image_noise": 0.0,
        "robot.sonar_noise_m": 0.0,
        "robot.sonar_false_echo": 0.0,
        "robot.laser_noise_m": 0.0,
        "robot.odometry_noise": 0.0,
        "robot.odometry_scale_error": 0.0,
        "robot.gyro_bias": 0.0,
    },
}
# What the pilot adds, switched off: it only wanders (IROS 2005 IV.D), bars stay and links are deleted (ACRA 2006 3.4), and
# the robot drives along the route to its end, and straight towards its next point.
_PLAIN_PILOT: dict[str, Value] = {
    "pilot.seek": False,
    "pilot.bar_fade_s": 0.0,
    "pilot.approach_m": 0.0,
    "pilot.gap_m": 0.0,
}
_OUR_PILOT: dict[str, Value] = {name: value for name, _, value in Config().items() if name in _PLAIN_PILOT}
_WITH_PILOT: dict[str, dict[str, Value]] = {
    name: {**values, **(_OUR_PILOT if name == "ours" else _PLAIN_PILOT)} for name, values in ENGINES.items()
}
PRESETS: dict[str, dict[str, Value]] = {**_WITH_PILOT, **ROBOTS}


def preset(name: str, base: Config) -> Config:
    """`base` with the values of a preset. ValueError lists the presets if none has this name."""
    return base.with_values(values_of(name))


def values_of(name: str) -> dict[str, Value]:
    """The parameters that a preset sets. Its name may be written in lower case with hyphens, as on a command line."""
    found = [values for known, values in PRESETS.items() if _plain(known) == _plain(name)]
    if not found:
        raise ValueError(f"unknown preset {name!r}; expected one of: {', '.join(PRESETS)}")
    return found[0]


def preset_of(config: Config) -> str:
    """The name of the preset whose values the config has, or "". If several fit: a paper, then a robot, then "ours"."""
    values = {name: value for name, _, value in config.items()}
    found = [name for name, wanted in PRESETS.items() if all(values[key] == value for key, value in wanted.items())]
    return next((name for name in found if name != "ours"), found[0] if found else "")


def _plain(name: str) -> str:
    return name.strip().lower().replace(" ", "-")

"""Named settings: the engine of each paper, our own, and two robots; a preset changes only the parameters it names. And
brains that are worth comparing with a first one, by name: what the second is depends on the first, so that they differ.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from app.config.tree import Config, Value
from ratslam_core.params.additions import ADDITIONS, Addition
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
# the robot drives along the route to its end. Obstacle avoidance stays on: IROS 2005 IV.D has one that it does not
# describe, the others do not say.
_PLAIN_PILOT: dict[str, Value] = {
    "pilot.seek": False,
    "pilot.bar_fade_s": 0.0,
    "pilot.approach_m": 0.0,
    "pilot.gap_m": Config().pilot.gap_m,
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


NAMES = "papers", "vision", "cells", "cells-64", "rate", "no-map"
FEW, MANY = 8, 64  # cells along x' and y'
SLOW, USUAL = 0.0015, 0.015
_ADDITIONS = {addition.name: addition for addition in ADDITIONS}


@dataclass(frozen=True, slots=True)
class Pair:
    """first, second: what the two are called. title, about: of the second, for who chooses it; values: what it has otherwise."""

    name: str
    first: str
    second: str
    title: str
    about: str
    values: dict[str, Value]


def engine_of(config: Config) -> str:
    """The paper whose rules the brain follows, "ours", or "as set"."""
    values = {name: value for name, _, value in config.items()}
    return next(
        (name for name, wanted in ENGINES.items() if all(values[key] == value for key, value in wanted.items())),
        "as set",
    )


def pairs_beside(config: Config) -> tuple[Pair, ...]:
    """Those that differ from a brain with this config."""
    return tuple(pair for pair in _pairs(config) if config.with_values(pair.values) != config)


def pair_of(name: str, config: Config) -> Pair:
    """A pair by name, which may be that of an addition. ValueError: there is none of this name, or nothing would differ."""
    if name in _ADDITIONS:
        return _addition(_ADDITIONS[name], config)
    require_pair(name)
    found = {pair.name: pair for pair in pairs_beside(config)}
    if name not in found:
        raise ValueError(f"the first brain is that already: nothing would differ; what would: {', '.join(found)}")
    return found[name]


def require_pair(name: str) -> str:
    """The name itself. ValueError: it is neither that of a pair nor that of an addition."""
    if name not in NAMES and name not in _ADDITIONS:
        ours = ", ".join(_ADDITIONS)
        raise ValueError(f"there is no pair {name!r}; expected one of: {', '.join(NAMES)}; or an addition: {ours}")
    return name


def without(addition: Addition, config: Config) -> bool:
    """Whether a brain with this config lacks the addition, or a part of it."""
    ours = ENGINES["ours"]
    values = {name: value for name, _, value in config.items() if name in addition.off}
    return any(
        value != ours[name] if isinstance(value, str) else value == addition.off[name] for name, value in values.items()
    )


def _addition(addition: Addition, config: Config) -> Pair:
    """The same brain without it; with it, if it is off."""
    name, values = addition.name, dict(addition.off)
    second = f"without {name}"
    if without(addition, config):
        second, values = f"with {name}", {dotted: ENGINES["ours"][dotted] for dotted in values}
    return Pair(name, engine_of(config), second, second.capitalize(), f"{addition.adds}: {addition.why}", values)


def _pairs(config: Config) -> Iterator[Pair]:
    rules = engine_of(config)
    if rules.startswith("paper-"):
        yield _rules("papers", rules, "ours", "Ours", "With what we have added to the papers.")
    else:
        about = "Those of 2006 by themselves, without what is ours."
        yield _rules("papers", rules, "paper-2006", "The papers' rules", about)
    yield _vision(config)
    yield from _cells(config)
    yield _rate(config)
    if rules == "paper-2004":
        yield _rules("no-map", rules, "paper-2006", "With a map, as in 2006", "Experiences and links beside the cells.")
    else:
        about = "The packet's place among the pose cells is the robot's place."
        yield _rules("no-map", rules, "paper-2004", "No map, as in 2004", about)


def _rules(name: str, first: str, second: str, title: str, about: str) -> Pair:
    return Pair(name, first, second, title, about, dict(ENGINES[second]))


def _vision(config: Config) -> Pair:
    off = "without vision", "Without vision", "It knows no view, so its pose cells are soon lost."
    on = "with vision", "With vision", "It recognises what it has seen before."
    (first, *_), (second, title, about) = (on, off) if config.local_view.enabled else (off, on)
    return Pair("vision", first, second, title, about, {"local_view.enabled": not config.local_view.enabled})


def _cells(config: Config) -> Iterator[Pair]:
    n_x, n_y = config.pose_cells.n_x, config.pose_cells.n_y
    few = "So few that the packet goes round them every few metres."
    many = "So many that it rarely goes round them."
    sizes = [("cells", MANY, many)] if (n_x, n_y) == (FEW, FEW) else [("cells", FEW, few), ("cells-64", MANY, many)]
    for name, size, about in sizes:
        words = f"{size} x {size}"
        values: dict[str, Value] = {"pose_cells.n_x": size, "pose_cells.n_y": size}
        yield Pair(name, f"{n_x} x {n_y} cells", f"{words} cells", f"{words} pose cells", about, values)


def _rate(config: Config) -> Pair:
    rate = config.local_view.learning_rate
    other, how = (SLOW, "slowly") if rate > SLOW else (USUAL, "quickly")
    about = f"It learns more {how} where a view belongs."
    values: dict[str, Value] = {"local_view.learning_rate": other}
    return Pair("rate", f"rate {rate:g}", f"rate {other:g}", f"Learning rate {other:g}", about, values)

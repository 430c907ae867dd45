"""The parameters with which a recording is played: those of the office, scaled by rules that look at the recording.

What a robot sees changes with the way it drives, and who drives in the open drives faster. So all lengths grow with the
typical speed; how alike views must be follows from how unlike they are. And who sees wide must not take a view for one that
is turned far: views are shifted by as large an angle as in the office, in columns of the camera that was used.
"""

from __future__ import annotations

from dataclasses import fields
from functools import partial

import numpy as np

from app.config import Config, Value
from app.recordings.motion import Motion
from app.recordings.recording import Recording
from app.recordings.scan_odometry import is_laser
from app.recordings.scan_rules import ScanRules
from app.recordings.survey import Survey, survey
from ratslam_core.local_view.front_ends import FRONT_ENDS

LEAST_SCALE, MOST_SCALE = 0.02, 50.0
UNRELATED, UNRELATED_SCANS = 0.0025, 0.002  # share of unrelated views that may be taken for one another
LOOK_SIGMA_M = 0.35  # of a look that is only just believed, in the office
LASER_SHIFT = 5  # columns of 3 degrees: a laser sees so well that a turn need not spoil a view
LASER_GATE_RAD = (
    0.8  # scans laid on scans keep the heading: a look that turns the robot farther at once is a look-alike
)
WIDTH_ERROR = 1.1  # the camera's width is measured to a tenth


def rules(recording: Recording, scans: ScanRules | None = None) -> tuple[Config, Motion]:
    """The parameters for this recording, and how its motion is read."""
    base = Config().with_value("local_view.front_end", _front_end(recording))
    laser = base.local_view.front_end == "laser"
    if laser:
        base = base.with_values({"local_view.shift": LASER_SHIFT, "occupancy.enabled": False})
    end, told = FRONT_ENDS[base.local_view.front_end](), base.local_view
    turned_rad = told.shift * told.field_of_view / end.columns
    shift_at = _laser_shift if laser else partial(columns_of, turned_rad, end.columns)
    seen = survey(recording, end, shift_at)
    usual = base.pilot.cruise_speed
    levels_per_m = 1.0
    scale = seen.speed / usual if seen.speed > 0 else 1.0
    if not recording.about.has & {"speed", "throttle"}:
        levels_per_m, scale = scale, 1.0
    scale = min(max(scale, LEAST_SCALE), MOST_SCALE)
    values: dict[str, Value] = {
        **_lengths(base, scale),
        **_views(recording, seen, scale),
        "experience_map.familiar_ground": False,
    }
    motion = Motion(recording.about, seen.dt, seen.field_of_view, levels_per_m, scans=scans or ScanRules())
    return base.with_values(values), motion


def columns_of(turned_rad: float, columns: int, field_of_view: float) -> int:
    """[ours] How many whole columns of such a camera are no more than this angle, or a tenth above it at most.

    A column of a wide camera is many degrees: views under such turns are other views, and shifting them makes look-alikes.
    test_playing.py::test_views_are_shifted_by_the_same_angle_whatever_the_camera. `local_view.shift` of a config wins.
    """
    return int(WIDTH_ERROR * turned_rad * columns / field_of_view)


def _laser_shift(_field_of_view: float) -> int:
    return LASER_SHIFT


def _front_end(recording: Recording) -> str:
    """What it sees with: a camera, beside sonars or not, or a laser."""
    about = recording.about
    if "camera" not in about.has:
        if not is_laser(about):
            raise ValueError(
                f"{about.name}: neither a camera nor a laser, so there is nothing that could be recognised"
            )
        return "laser"
    return "image and sonars" if about.beam_angles_rad and not is_laser(about) else "limited levels"


def _lengths(base: Config, scale: float) -> dict[str, Value]:
    """The lengths of the engine, times the scale, as far as their ranges go. Those of the map are in cells."""
    own = {section.name for section in fields(base.engine)}
    values: dict[str, Value] = {}
    for name, item, value in base.items():
        if name.split(".")[0] in own and item.metadata["unit"] == "m" and isinstance(value, float):
            values[name] = min(max(value * scale, item.metadata["low"]), item.metadata["high"])
    return values


def _views(recording: Recording, seen: Survey, scale: float) -> dict[str, Value]:
    """How alike views must be."""
    values: dict[str, Value] = {
        "local_view.field_of_view": seen.field_of_view,
        "local_view.shift": seen.shift,
    }
    if "camera" not in recording.about.has and is_laser(recording.about):
        values["local_view.field_of_view"] = _span(recording.about.beam_angles_rad)
        values["evidence.gate_rad"] = LASER_GATE_RAD
    # Pictures of real cameras jump when one is dropped, so a jump is no kidnap: only a gap in the recording is.
    values |= {"local_view.surprise": 100.0, "kidnap.range_surprise": 0.0}
    if len(seen.unlike) == 0:
        return values
    share = UNRELATED if "camera" in recording.about.has else UNRELATED_SCANS
    threshold, own = float(np.quantile(seen.unlike, share)), FRONT_ENDS[_front_end(recording)].threshold
    values["local_view.match_threshold"] = threshold / own
    # Where most views are the same, as of a camera that stood still, the threshold is 0.
    values["experience_map.anchor_sigma"] = min(LOOK_SIGMA_M * scale / threshold, 1.0) if threshold > 0 else 1.0
    return values


def _span(angles_rad: tuple[float, ...]) -> float:
    """The angle that all beams together cover, half a beam to either side included."""
    return min((max(angles_rad) - min(angles_rad)) * len(angles_rad) / (len(angles_rad) - 1), 2 * np.pi)

"""The parameters with which a recording is played: those of the office, scaled by rules that look at the recording.

What a robot sees changes with the way it drives, and who drives in the open drives faster. So all lengths grow with the
typical speed; how alike views must be follows from how unlike they are.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from app.config import Config, Value
from app.recordings.motion import Motion
from app.recordings.recording import Recording
from app.recordings.survey import Survey, survey
from ratslam_core.local_view.front_ends import named_front_end

LEAST_SCALE, MOST_SCALE = 0.02, 50.0
UNRELATED = 0.01  # share of unrelated views that may be taken for one another
LOOK_SIGMA_M = 0.35  # of a look that is only just believed, in the office
LOUD = ("local_view.", "kidnap.", "occupancy.")  # their lengths are those of echoes, which do not grow with the speed


def rules(recording: Recording) -> tuple[Config, Motion]:
    """The parameters for this recording, and how its motion is read."""
    base = Config()
    seen = survey(recording, named_front_end(base.local_view), base.local_view.shift)
    usual = base.pilot.cruise_speed
    levels_per_m = 1.0
    scale = seen.speed / usual if seen.speed > 0 else 1.0
    if not recording.about.has & {"speed", "throttle"}:
        levels_per_m, scale = scale, 1.0
    scale = min(max(scale, LEAST_SCALE), MOST_SCALE)
    values: dict[str, Value] = {**_lengths(base, scale), **_views(seen, scale), "memory.familiar": False}
    motion = Motion(recording.about, seen.dt, seen.field_of_view, levels_per_m)
    return base.with_values(values), motion


def _lengths(base: Config, scale: float) -> dict[str, Value]:
    """All lengths of the engine, times the scale, as far as their ranges go."""
    values: dict[str, Value] = {}
    own = {section.name for section in fields(base.engine)}
    for name, item, value in base.items():
        if name.split(".")[0] not in own or name.startswith(LOUD) or isinstance(value, str):
            continue
        power = {"m": 1, "rad/m": -1}.get(item.metadata["unit"], 0)
        if power:
            low, high = item.metadata["low"], item.metadata["high"]
            values[name] = min(max(value * scale**power, low), high)
    return values


def _views(seen: Survey, scale: float) -> dict[str, Value]:
    """How alike views must be."""
    values: dict[str, Value] = {"local_view.field_of_view": seen.field_of_view, "local_view.deaf_doubt": 0.0}
    if len(seen.unlike) == 0 or len(seen.alike) == 0:
        return values
    threshold = float(np.quantile(seen.unlike, UNRELATED))
    values["local_view.composite_threshold"] = threshold
    values["experience_map.anchor_sigma"] = min(LOOK_SIGMA_M * scale / threshold, 1.0)
    values["local_view.composite_surprise"] = 100.0
    return values

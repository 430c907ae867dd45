"""What is true of the evaluation between two ticks."""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from app.evaluation import Evaluation
from app.evaluation.kidnapping import Kidnapping, Stretch
from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import FAR_M, array, number, pose, true, whole, within

LONGEST_S = 1e12
MOST_TURNED = 1e9  # rad


def evaluation(evaluation: Evaluation, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the map has."""
    true(isinstance(evaluation, Evaluation), f"its evaluation is a {type(evaluation).__name__}")
    same_kind("evaluation", evaluation, Evaluation())
    rows = array("the path", evaluation._rows, np.float64, (None, 8))
    count = whole("the path's length", evaluation._count, 1, len(rows))
    within("the path", rows[:count], -MOST_TURNED, MOST_TURNED)
    active = array("active experiences", evaluation._experience, np.int64, (len(rows),))
    within("active experiences", active[:count], 0, experiences - 1)
    made = array("where experiences were made", evaluation._made_at, np.float64, (None, 4))
    true(len(made) >= experiences, f"where {experiences} experiences were made must be known or not, got {len(made)}")
    true(not np.isinf(made).any(), "where experiences were made must be a place, or not known")
    pose("odometry alone", evaluation._odometry)
    whole("visits that agree", evaluation._consistent, 0, whole("visits", evaluation._revisits))
    number("the path", evaluation.path_m, 0.0, LONGEST_S)
    for kidnap in evaluation.kidnaps:
        true(isinstance(kidnap, Kidnapping), "a kidnap must be one")
        _kidnap(kidnap, experiences)


def _kidnap(kidnap: Kidnapping, experiences: int) -> None:
    number("the time of a kidnap", kidnap.at_s, 0.0, LONGEST_S)
    pose("the map before a kidnap", kidnap.map_in_office)
    whole("what was known before a kidnap", kidnap.known, 0, experiences)
    whole("ticks before a kidnap", kidnap.ticks, 0)
    number("the way since a kidnap", kidnap._way_m, 0.0, FAR_M)
    true(isinstance(kidnap._noticed, bool), "whether a kidnap was noticed must be true or false")
    for name in ("after_s", "after_m", "joined_s", "consistent_s"):
        _time(name, getattr(kidnap, name))
    for name in ("wrong", "_right", "_agrees"):
        stretch = getattr(kidnap, name)
        true(isinstance(stretch, Stretch), f"a kidnap's {name} must be a stretch")
        _time(f"{name} since", stretch.since_s)
        number(f"a kidnap's {name} at most", stretch.most_s, 0.0, LONGEST_S)
        number(f"a kidnap's {name} after", stretch.way_m, 0.0, FAR_M)


def _time(name: str, value: float | None) -> None:
    if value is not None:
        number(f"a kidnap's {name}", value, 0.0, LONGEST_S)

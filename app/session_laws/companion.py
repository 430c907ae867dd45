"""What is true of a second brain between two ticks."""

# Laws do not trust annotations.
# pyright: reportUnnecessaryIsInstance=false

from __future__ import annotations

from app.companion import SECTIONS, Companion, Parting
from app.comparing import LONGEST_NAME
from app.config import Config
from app.session_laws.evaluation import LONGEST_S, evaluation
from ratslam_core import Estimate, RatSlam, laws
from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import number, true, whole


def companion(companion: Companion, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the first brain has."""
    true(isinstance(companion, Companion), f"its second brain is a {type(companion).__name__}")
    for name in (companion.first, companion.name):
        true(isinstance(name, str) and 0 < len(name) <= LONGEST_NAME, "two brains that are compared must have names")
    same_kind("the second brain's config", companion.config, Config())
    true(isinstance(companion.values, dict), "what makes the difference must be a table")
    known = {name for name, _, _ in companion.config.items()}
    for name in companion.values:
        true(name in known and name.split(".")[0] in SECTIONS, f"{name!r} is no parameter of a brain")
    true(isinstance(companion.brain, RatSlam), f"the second brain is a {type(companion.brain).__name__}")
    laws.check(companion.brain)
    own = len(companion.brain.experience_map)
    evaluation(companion.evaluation, own)
    true(companion.ties is None, "a second brain in an office has no laser's scans to tie")
    true(isinstance(companion.estimate, Estimate), "what the second brain believes must be an estimate")
    number("since when there is a second brain", companion.since_s, 0.0, LONGEST_S)
    true(isinstance(companion.parting, Parting), "how two brains differ must be told by a parting")
    true(isinstance(companion.counterpart, list), "the counterparts must be a list")
    true(len(companion.counterpart) <= experiences, f"there are {experiences} experiences to have a counterpart")
    for own_one in companion.counterpart:
        whole("a counterpart", own_one, -1, own - 1)

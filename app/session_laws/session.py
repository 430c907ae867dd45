"""What is true of a session as a whole, and of its last step."""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from app.config import Config
from app.orders import MOST_TAGS
from app.session import Session
from app.session_laws.companion import companion
from app.session_laws.evaluation import evaluation
from app.session_laws.pilot import pilot
from app.session_laws.simulator import simulator
from ratslam_core import Estimate, Odometry, RatSlam, laws
from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import number, pose, true, whole
from sim2d import SONAR_ANGLES_RAD, World

LONGEST_NAME = 40
_PARTS = {"seed", "config", "simulator", "brain", "pilot", "evaluation", "odometry", "estimate", "tags"}


def check(session: Session, world: World) -> None:
    """ValueError names the first law that does not hold of a session in this world."""
    odd = (vars(session).keys() - {"companion"}) ^ (_PARTS | set(Session.CACHES))
    true(not odd, f"a session differs in {', '.join(sorted(odd))}: it was made by another version")
    whole("seed", session.seed, 0, 2**64)
    same_kind("config", session.config, Config())
    simulator(session.simulator, world)
    true(isinstance(session.brain, RatSlam), f"its brain is a {type(session.brain).__name__}")
    laws.check(session.brain)
    occupancy, n = session.brain.occupancy, len(session.brain.experience_map)
    true(
        occupancy is not None and np.array_equal(occupancy._angles, SONAR_ANGLES_RAD),
        "its brain has other sonars than its robot",
    )
    pilot(session.pilot, n)
    evaluation(session.evaluation, n)
    true(isinstance(session.tags, dict) and len(session.tags) <= MOST_TAGS, "tags must be a table, and not too many")
    for name, experience in session.tags.items():
        true(isinstance(name, str) and 0 < len(name) <= LONGEST_NAME, f"a tag must have a name, got {name!r}")
        whole(f"the experience tagged {name!r}", experience, 0, n - 1)
    _last_step(session, n, len(session.brain.local_view))
    if session.companion is not None:
        companion(session.companion, n)


def _last_step(session: Session, experiences: int, views: int) -> None:
    told, estimate = session.odometry, session.estimate
    true(isinstance(told, Odometry), "the odometry must be one")
    for name in ("speed", "yaw_rate", "dt"):
        number(f"the odometry's {name}", getattr(told, name), -1e6, 1e6)
    true(isinstance(estimate, Estimate), "the estimate must be one")
    whole("the estimate's experience", estimate.experience, 0, experiences - 1)
    pose("the estimate's pose", estimate.pose_map_robot)
    for name in ("view", "best_view"):
        whole(f"the estimate's {name}", getattr(estimate.recognition, name), -1, views - 1)

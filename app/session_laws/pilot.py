"""What is true of the pilot between two ticks."""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

from typing import get_args

import numpy as np

from app.pilot import Mode, Pilot, PilotParams
from app.pilot.bars import Bar, Bars
from app.pilot.behaviours import Behaviour
from app.pilot.explore import Explorer, Turn
from app.pilot.known_ground import KnownGround
from app.pilot.route_following import RouteFollower
from app.pilot.seeking import Seeker
from ratslam_core import Route
from ratslam_core.laws.beats import beats
from ratslam_core.laws.kinds import same_kind
from ratslam_core.laws.measures import FAR_M, array, number, true, whole, within
from sim2d import SONAR_ANGLES_RAD
from web.messages import GoalState

MOST_TURNED = 1e9  # rad
LONGEST_S = 1e12


def pilot(pilot: Pilot, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the map has."""
    true(isinstance(pilot, Pilot), f"its pilot is a {type(pilot).__name__}")
    fresh = Pilot(PilotParams(), np.array(SONAR_ANGLES_RAD), np.random.default_rng(0))
    same_kind("pilot", pilot, fresh)
    true(pilot.mode in get_args(Mode), f"the mode must be one of {', '.join(get_args(Mode))}, got {pilot.mode!r}")
    true(pilot._behaviour in Behaviour.__members__, f"the pilot cannot be {pilot._behaviour!r}")
    place = array("the pilot's place", pilot._freeing._place, np.float64, (3,))
    within("the pilot's place", place, -MOST_TURNED, MOST_TURNED)
    local = pilot._local
    true(np.array_equal(local._angles, SONAR_ANGLES_RAD), "the pilot must know the robot's sonars")
    scans = whole("scans that are remembered", local._scans, 1, 10**6)
    echoes = array("echoes", local._echoes, np.float64, (scans * len(SONAR_ANGLES_RAD), 2))
    true(not np.isnan(echoes).any(), "echoes must be places, or none")
    whole("the echoes' beat", local._beat, -1)
    beats(local._beats)
    _explorer(pilot._explorer)
    one = pilot._explorer._rng is pilot._rng is pilot._freeing._rng
    true(one, "all parts of the pilot must draw from one generator")
    _bars(pilot._bars)
    _seeker(pilot._seeker, experiences)
    shared = pilot._seeker._bars is pilot._bars
    true(shared, "who seeks must know the pilot's bars")
    if pilot._follower is not None:
        true(pilot._follower._bars is pilot._bars, "who follows a route must know the pilot's bars")
        _follower(pilot._follower, experiences)


def _explorer(explorer: Explorer) -> None:
    true(explorer._state in ("follow", "cross", "look"), f"the explorer cannot be in the state {explorer._state!r}")
    whole("the explorer's stage", explorer._stage, 0, 1)
    if explorer._turn is not None:
        true(isinstance(explorer._turn, Turn), "the explorer's turn must be one")
        number("what is left of the turn", explorer._turn.left, -MOST_TURNED, MOST_TURNED)


def _follower(follower: RouteFollower, experiences: int) -> None:
    true(isinstance(follower, RouteFollower), "who follows a route must be a RouteFollower")
    same_kind("route follower", follower, RouteFollower(0))
    true(isinstance(follower.goals, list) and len(follower.goals) > 0, "a route must lead to a goal")
    for goal in follower.goals:
        whole("the goal", goal, 0, experiences - 1)
    true(follower.state in get_args(GoalState), f"the way to a goal cannot be {follower.state!r}")
    if follower._route is not None:
        true(isinstance(follower._route, Route), "the route must be one")
        nodes = array("the route", follower._route.experiences, np.int64, (None,))
        within("the route", nodes, 0, experiences - 1)
        times = array("times of the route", follower._route.arrival_s, np.float64, (len(nodes),))
        within("times of the route", times, 0.0, LONGEST_S)
        whole("how far the route has been driven", follower._at, 0, len(nodes) - 1)


def _seeker(seeker: Seeker, experiences: int) -> None:
    ground = seeker.ground
    true(isinstance(ground, KnownGround), "known ground must be one")
    true(np.array_equal(ground._angles, SONAR_ANGLES_RAD), "known ground must know the robot's sonars")
    count = whole("experiences of the known ground", ground.count, 0, experiences)
    rows = len(array("times of visits", ground._last_s, np.float64, (None,)))
    true(rows >= count, "every experience must have a time of its last visit")
    array("times of making", ground._made_s, np.float64, (rows,))
    seen = array("what was seen of the ground", ground._seen_m, np.float32, (rows, len(SONAR_ANGLES_RAD)))
    within("what was seen of the ground", seen, 0.0, FAR_M)
    for name, value in (("time", ground.now_s), ("way on new ground", ground.new_m)):
        number(f"the {name} of the known ground", value, 0.0, LONGEST_S)
    for place in ground._done:
        within("an opening", np.array(place, np.float64), -FAR_M, FAR_M)
    if seeker.follower is not None:
        _follower(seeker.follower, experiences)
    whole("trips", seeker._trips)


def _bars(bars: Bars) -> None:
    for bar in bars._bars:
        true(isinstance(bar, Bar), "a bar must be one")
        within("a bar", array("a bar", bar.ends, np.float64, (2, 2)), -FAR_M, FAR_M)
        number("what is left of a bar", bar.left_s, -LONGEST_S, LONGEST_S)
        number("how long a bar lasts", bar.lasts_s, 0.0, LONGEST_S)
        whole("failures at a bar", bar.failures, 1)

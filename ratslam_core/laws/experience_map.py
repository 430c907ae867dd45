"""What is true of the experience map between two steps."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np

from ratslam_core.experience_map.experience_map import ExperienceMap, _Arrival
from ratslam_core.extensions.evidence import CEILING, SUBMAP, Belief, Evidence
from ratslam_core.extensions.evidence import MOST as MOST_HYPOTHESES
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import MOST_NEAR, FamiliarGround
from ratslam_core.extensions.odometry_edges import OdometryEdges
from ratslam_core.laws import experiences as law
from ratslam_core.laws.measures import FAR_M, MOST, array, number, pose, true, whole, within
from ratslam_core.pose_graph.preintegrated import PreintegratedOdometry

LONGEST = 1e12  # metres and seconds
FASTEST = 10.0  # rad/s, the largest yaw bias


def experience_map(map_: ExperienceMap, views: int) -> None:
    """ValueError names the first law that does not hold. views: how many local view cells there are."""
    true(map_._experiences.shape == map_.shape, "the experiences must be of the same pose cells")
    true(map_._temporal_map._map is map_, "the temporal map must be of the same experiences")
    law.experiences(map_._experiences, views)
    n = len(map_)
    within("an island", map_._experiences.island[:n], 0, map_.islands.begun)
    law.transitions(map_.transitions, n)
    whole("the active experience", map_.here, 0 if n else -1, n - 1)
    pose("the robot's place", map_.pose_filter.local)
    number("how far off it may be", map_.pose_filter.sigma_m, 0.0, LONGEST)
    pose("offset", map_._offset)
    pose("travel", map_._travel)
    for name in ("_driven_m", "_driving_s", "_sigma"):
        number(name[1:], getattr(map_, name), 0.0, LONGEST)
    number("yaw bias", map_.yaw_bias, -FASTEST, FASTEST)
    for name in ("closures", "steps", "corrected"):
        whole(name, getattr(map_, name))
    _leg(map_._leg)
    if isinstance(map_._edges, OdometryEdges):
        whole("the latest experience", map_._edges.latest, -1, n - 1)
        _leg(map_._edges.since)
    if isinstance(map_.ground, FamiliarGround):
        _ground(map_.ground, n, views)
    if isinstance(map_.optimiser, ExactSolver):
        _solver(map_.optimiser)
    if map_._arrival is not None:
        _arrival(map_._arrival, map_.transitions.count)
    whole("the latest island", map_.islands.begun)
    whole("the island", map_.islands.current, 0, map_.islands.begun)
    whole("joined islands", map_.islands.joined, 0, map_.islands.begun)
    if map_.islands.merge is not None:
        whole("the first experience of a merge", map_.islands.merge.first, 0, n)
        number("the log odds of a merge", map_.islands.merge.log_odds, -LONGEST, LONGEST)
    _evidence(map_.evidence, n, map_.islands.begun)


def _evidence(evidence: Evidence, n: int, submaps: int) -> None:
    whole("experiences among which the evidence is", evidence.known, 0, n)
    whole("hypotheses", evidence._count, 0, MOST_HYPOTHESES)
    rows = array("hypotheses", evidence._rows, np.float64, (MOST_HYPOTHESES, 7))
    within("a hypothesis", rows[:, :CEILING], -FAR_M, FAR_M)
    true(not np.isnan(rows[:, CEILING]).any(), "a hypothesis must have a ceiling")
    within("a hypothesis' submap", rows[: evidence._count, SUBMAP], 0, submaps)
    number("the way since the last observation", evidence._units, 0.0, 1.0)
    number("the way since a doubt", evidence._quiet, 0.0, LONGEST)
    number("log odds of here", evidence.here, -FAR_M, FAR_M)
    for name in ("sure", "in_doubt"):
        true(isinstance(getattr(evidence, name), bool), f"{name} must be true or false")
    if evidence.belief is not None:
        true(isinstance(evidence.belief, Belief), "what is believed must be a belief")
        whole("the experience that is believed", evidence.belief.experience, 0, n - 1)
        pose("the place that is believed", evidence.belief.pose)
        number("log odds", evidence.belief.log_odds, -FAR_M, FAR_M)
        number("the facing that is believed", evidence.belief.facing_rad, -FAR_M, FAR_M)


def _ground(ground: FamiliarGround, n: int, views: int) -> None:
    for name in ("spared", "adopted", "links_spared", "views_faded"):
        whole(name, getattr(ground, name))
    share = array("shares", ground._share, np.float64, (None,))
    true(len(share) >= n, "each experience must have a share of recognised sights")
    within("a share", share, 0.0, 1.0)
    unseen = array("unseen", ground._unseen, np.int64, share.shape)
    within("a count of sights", unseen, 0, MOST)
    whole("the faded view", ground.faded, -1, views - 1)
    near = array("what is near", ground._near, np.int64, (MOST_NEAR,))
    within("an experience nearby", near[: whole("how many are near", ground._found, 0, MOST_NEAR)], 0, n - 1)


def _solver(solver: ExactSolver) -> None:
    for name in ("_solved_at", "_closures_at_solve"):
        whole(name, getattr(solver, name))
    number("the rest after a solution", solver._rest_after_solve, 0.0, LONGEST)


def _leg(leg: PreintegratedOdometry) -> None:
    pose("a leg's move", leg.moved)
    for name in ("way_m", "turning_s", "time_s"):
        number(f"a leg's {name}", getattr(leg, name), 0.0, LONGEST)


def _arrival(arrival: _Arrival, rows: int) -> None:
    true(isinstance(arrival, _Arrival), "the arrival must be one")
    whole("the arrival's row", arrival.row, 0, rows - 1)
    within("the arrival's move", array("the arrival's move", arrival.move, np.float64, (3,)), -FAR_M, FAR_M)
    number("the arrival's weight", arrival.weight, 0.0, law.LARGEST)
    pose("where the robot came from", arrival.came)
    number("the arrival's sigma", arrival.sigma, 0.0, LONGEST)

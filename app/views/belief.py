"""Uncertainty of the pose estimate, the hypotheses beside it, and the evidence for each. Poses in m and rad, map frame."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from ratslam_core import CellsOnly, ExperienceMap, Pose2, wrap_angles
from ratslam_core.extensions.evidence import HEADING, ODDS, SUBMAP, X, Y
from web.messages import Belief, Hypothesis, Spread

POSSIBLE = 3.0  # nats: a place that is twenty times less likely than the likeliest, or than a new one, is not counted
MOST_LOG_ODDS = 14.0  # a million to one is enough
MOST_OTHERS = 4  # hypotheses that are shown beside the pose estimate
HELD_M = 1.0  # a place stands for a state of the pose cells if an experience is so near
LEAST_SHARE = 0.02  # how likely a place must be before one is shown that a robot in doubt may be at


def belief_of(session: Session) -> Belief:
    brain = session.brain
    map_ = brain.experience_map
    return Belief(
        off_m=math.inf if map_.carried else map_.off_m,
        others=other_places(map_),
        corrected=map_.corrected,
        apart=int(np.count_nonzero(map_.submap_of != map_.submaps.current)),
        joined=map_.submaps.merged,
        spared=map_.ground.let_go.get("sights", 0),
        links_spared=map_.ground.let_go.get("links", 0),
        forgotten=brain.view_links.forgotten,
        odds=None if map_.belief is None else math.exp(min(map_.belief.log_odds, MOST_LOG_ODDS)),
        places=len(possible_places(map_)),
    )


def possible_places(map_: ExperienceMap) -> NDArray[np.float64]:
    """x, y (m), heading (rad) of the places where a robot that was carried may be, the likeliest first, shape (n, 3)."""
    if not map_.carried:
        return np.zeros((0, 3))
    rows = map_.evidence.hypotheses
    likely = rows[np.argsort(-rows[:, ODDS], kind="stable")]
    return likely[likely[:, ODDS] > likely[:1, ODDS].max(initial=0.0) - POSSIBLE][:, :3].copy()


def other_places(map_: ExperienceMap) -> tuple[Hypothesis, ...]:
    """The hypotheses beside the pose estimate, after a kidnap or in doubt, the likeliest first."""
    rows, beside = map_.evidence.weighed(map_)
    if not len(rows) or not (map_.carried or map_.evidence.in_doubt):
        return ()
    all_odds = np.append(rows[:, ODDS], beside)
    every = np.exp(all_odds - np.logaddexp.reduce(all_odds))
    shares = every[: len(rows)]
    here, found = map_.robot, list[Hypothesis]()
    least = every.max() * math.exp(-POSSIBLE) if map_.carried else LEAST_SHARE
    for k in np.argsort(-shares, kind="stable").tolist():
        x, y, heading = rows[k, :3].tolist()
        if shares[k] >= least and math.hypot(x - here.x, y - here.y) > 1e-6:
            state = state_of(map_, Pose2(x, y, heading), int(rows[k, SUBMAP]))
            found.append(Hypothesis(x, y, heading, float(shares[k]), state))
    return tuple(found[:MOST_OTHERS])


def state_of(map_: ExperienceMap, place: Pose2, submap: int) -> tuple[float, float, float] | None:
    """The state of the pose cells of the submap's nearest experience, moved by as much as the place is beside it."""
    own = np.flatnonzero(map_.submap_of == submap)
    apart = np.hypot(map_.poses[own, 0] - place.x, map_.poses[own, 1] - place.y)
    if not len(own) or apart.min() > HELD_M:
        return None
    near = int(own[np.argmin(apart)])
    x, y, theta, _ = map_.cell_state(near)
    beside = map_.pose(near).inverse().compose(place)
    facing = theta * math.tau / map_.shape[0]
    state = Pose2(x * map_.cell_m, y * map_.cell_m, facing).compose(beside)
    return state.x / map_.cell_m, state.y / map_.cell_m, state.heading_rad


REACH = 6  # cells from the packet's centre: what is farther away belongs to another packet


def spread_of(session: Session) -> Spread | None:
    """[ours] How far off the robot may be, as an ellipse around its estimate: by the pose filter, which weighs
    observations against odometry; by the rules of the papers, which have none, from the spread of the winning packet.
    None without a map: nothing would be there to draw it on. test_judged_views.py checks both."""
    map_ = session.brain.experience_map
    if isinstance(map_, CellsOnly):
        return None
    sigma = map_.off_m
    if math.isfinite(sigma):
        return Spread(sigma, sigma, 0.0, "filter")
    return packet_spread(session)


def packet_spread(session: Session) -> Spread:
    """The covariance of the winner's activity in x', y', turned into the map's frame by the robot's two headings."""
    brain = session.brain
    cells, values = brain.pose_cells.active
    packet, (_, n_y, n_x) = brain.pose_cells.winner, brain.pose_cells.shape
    dx = _around(cells[:, 0] - packet.x, n_x)
    dy = _around(cells[:, 1] - packet.y, n_y)
    near = np.hypot(dx, dy) <= REACH
    weights, points = values[near].astype(np.float64), np.stack([dx[near], dy[near]])
    if weights.sum() <= 0:
        return Spread(0.0, 0.0, 0.0, "packet")
    middle = (points * weights).sum(1) / weights.sum()
    off = points - middle[:, None]
    variances, axes = np.linalg.eigh((off * weights) @ off.T / weights.sum())
    across, along = (brain.params.pose_cells.cell_m * math.sqrt(max(v, 0.0)) for v in variances.tolist())
    turn = brain.experience_map.robot.heading_rad - packet.heading_rad
    return Spread(along, across, math.remainder(math.atan2(axes[1, 1], axes[0, 1]) + turn, math.pi), "packet")


def _around(apart: np.ndarray, size: int) -> np.ndarray:
    return apart - size * np.round(apart / size)


MOST_TICKS = 1800  # that are looked back on
SAME_M, SAME_RAD = 0.5, 0.4  # in a tick no hypothesis goes farther
BARS = 24


class HypothesisHistory:
    """The evidence for and against the hypothesis that became the pose estimate. Call `watch` after each tick."""

    def __init__(self) -> None:
        self._kept: deque[tuple[float, NDArray[np.float64]]] = deque(maxlen=MOST_TICKS)

    def watch(self, time_s: float, map_: ExperienceMap) -> None:
        """Keep the hypotheses of this tick; none once the submaps are merged, so that the next time begins anew."""
        if map_.carried:
            self._kept.append((time_s, map_.evidence.hypotheses[:, [X, Y, HEADING, ODDS]].copy()))
        else:
            self._kept.clear()

    def of(self, place: Pose2) -> list[tuple[float, float]]:
        """Since when this place was a hypothesis, and what was said of it then: (s, nats), at most BARS of them.

        The first is what it began with. Positive speaks for it.
        """
        at, odds = np.array([place.x, place.y, place.heading_rad]), list[tuple[float, float]]()
        for time_s, rows in reversed(self._kept):
            off = np.hypot(rows[:, 0] - at[0], rows[:, 1] - at[1])
            turn = np.abs(wrap_angles(rows[:, 2] - at[2]))
            near = np.flatnonzero((off < SAME_M) & (turn < SAME_RAD))
            if not len(near):
                break
            row = rows[near[np.argmin(off[near])]]
            at = row[:3]
            odds.append((time_s, float(row[3])))
        return _said(odds[::-1])


def _said(odds: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Log odds over time as changes, in so many parts."""
    ends = [odds[(k + 1) * len(odds) // min(BARS, len(odds)) - 1] for k in range(min(BARS, len(odds)))]
    before = [0.0, *(value for _, value in ends)]
    return [(time_s, value - old) for (time_s, value), old in zip(ends, before, strict=False)]

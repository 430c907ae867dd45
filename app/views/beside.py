"""The second brain as it is drawn, and how the two differ, in figures and words."""

from __future__ import annotations

import math

import numpy as np

from app.companion import Companion
from app.config import Config
from app.session import Session
from app.views.arrays import Slow, frozen
from app.views.belief import other_places
from app.views.history import BesideHistory, History
from app.views.map_layers import MapLayers, layer_of
from app.views.office import goal_view
from ratslam_core import RatSlam
from web.messages import BesideView, BrainFigures, Changed, Difference, Goal, Packet, Pose, Snap

GOAL_EVERY_S = 0.25  # of wall time


class BesideDrawn:
    """Draws the companion of a session, as long as there is one."""

    def __init__(self, session: Session, history: History) -> None:
        self._session, self._history = session, history
        self._of: Companion | None = None
        self._map: MapLayers | None = None
        self._goal: Slow[Goal | None] | None = None
        self._changed: tuple[Config, Config, tuple[Changed, ...]] | None = None

    def refresh(self) -> None:
        if self._map is not None:
            self._map.refresh()
        if self._goal is not None:
            self._goal.refresh()

    def look(self) -> BesideView | None:
        session, companion, history = self._session, self._session.companion, self._history.beside
        if companion is None or history is None:
            self._of = self._map = self._goal = None
            return None
        brain, map_ = companion.brain, companion.brain.experience_map
        if self._of is not companion or self._map is None or self._goal is None:
            self._goal = Slow(GOAL_EVERY_S, lambda: _goal(session, companion))
            self._of = companion
            self._map = MapLayers(lambda: map_, lambda: companion.evaluation, lambda: goals_of(session, companion))
        layer, times = self._map.layers()
        series = self._history.series
        return BesideView(
            first=_figures(companion.first, session, session.brain, session, series.error_map_m),
            second=_figures(companion.name, session, brain, companion, history.error_map_m),
            since_s=companion.since_s,
            error_odometry_m=series.error_odometry_m,
            differences=differences_of(companion),
            changed=self._changed_of(session.config, companion.config),
            pose_cells=layer_of(brain.pose_cells, history.path, _snap(history)),
            map=layer,
            times=times,
            estimate=Pose(map_.robot.x, map_.robot.y, map_.robot.heading_rad),
            others=other_places(map_),
            goal=self._goal.part(session.tick_count),
            map_turn_rad=history.map_turn_rad,
        )

    def _changed_of(self, first: Config, second: Config) -> tuple[Changed, ...]:
        """The same object as long as both are the same."""
        if self._changed is None or self._changed[0] is not first or self._changed[1] is not second:
            pairs = zip(first.items(), second.items(), strict=True)
            changed = tuple(Changed(name, one, two) for (name, _, one), (_, _, two) in pairs if one != two)
            self._changed = first, second, changed
        return self._changed[2]


def goals_of(session: Session, companion: Companion) -> tuple[int, ...]:
    """The companion's experiences for the goals of the first: those in which it was when the first made them."""
    at = companion.counterpart
    known = [at[goal] for goal in session.pilot.goals if goal < len(at) and at[goal] >= 0]
    return tuple(dict.fromkeys(known))


def differences_of(companion: Companion) -> tuple[Difference, ...]:
    """What has differed so far, each by its first time, the earliest first."""
    divergence, found = companion.divergence, list[Difference]()
    if divergence.packet is not None:
        found.append(Difference("packet", *divergence.packet, "the winning packets are at different places"))
    if divergence.view is not None:
        tick, time_s, one, other = divergence.view
        found.append(
            Difference("view", tick, time_s, f"{companion.first} sees {_view(one)}, {companion.name} {_view(other)}")
        )
    if divergence.experience is not None:
        tick, time_s, one, other = divergence.experience
        found.append(
            Difference(
                "experience", tick, time_s, f"{companion.first} is in experience #{one}, {companion.name} in #{other}"
            )
        )
    if divergence.link is not None:
        tick, time_s, start, end, first = divergence.link
        who = companion.first if first else companion.name
        found.append(Difference("link", tick, time_s, f"only {who} has the link #{start} to #{end}"))
    return tuple(sorted(found, key=lambda difference: difference.tick))


def _view(number: int) -> str:
    return "no view" if number < 0 else f"view #{number}"


def _figures(
    name: str, session: Session, brain: RatSlam, judged: Session | Companion, error_m: float | None
) -> BrainFigures:
    off_m = None
    if session.truth is not None:
        off_m, _ = judged.evaluation.belief_off(session.truth, brain.experience_map)
    map_ = brain.experience_map
    return BrainFigures(
        name, len(brain.local_view), len(map_), map_.link_count, brain.relocalisations, error_m,
        None if off_m is None or math.isnan(off_m) else off_m, brain.lost,
    )  # fmt: skip


def _snap(history: BesideHistory) -> Snap | None:
    if history.last_snap is None:
        return None
    time_s, *ends = history.last_snap
    start, end = (Packet(p.x, p.y, p.heading_rad, p.mass, p.id) for p in ends)
    return Snap(time_s, start, end)


def _goal(session: Session, companion: Companion) -> Goal | None:
    """The goal of the first in the map of the second, and the way that this one would take."""
    told, goals = goal_view(session), goals_of(session, companion)
    if told is None or not goals:
        return None
    map_ = companion.brain.experience_map
    way = session.pilot.way_through(map_, goals)
    place = map_.pose(goals[0])
    state = "unreachable" if way.eta_s is None and told.state != "arrived" else told.state
    return Goal(
        goals[0], place.x, place.y, state, way.eta_s, way.remaining_m,
        frozen(map_.poses[way.route, :2].astype(np.float32)), frozen(way.arrival_s.astype(np.float32)),
        frozen(map_.poses[list(goals), :2].astype(np.float32)), companion.brain.lost, told.followed, way.why,
    )  # fmt: skip

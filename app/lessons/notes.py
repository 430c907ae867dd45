"""What is written down while a lesson is shown, and the numbers that come of it. Nothing goes back to the robot."""

from __future__ import annotations

import math

import numpy as np

from app.lessons.conditions import SHARE
from app.lessons.findings import Values
from app.trials.course import Course
from app.trials.measures import Phenomena, TurnOfCells, WayTaken
from app.views.history import History
from ratslam_core import Packet

RIVAL = 0.2  # a second packet with this share of the activity is a rival
HERE_M = 0.5
ERROR_EVERY = 10  # ticks between two looks at the whole map
COUNTED = ("snap", "closure")


class Notes:
    """Made when the showing begins; call `note` after each tick of it."""

    def __init__(self, course: Course, history: History) -> None:
        session = course.session
        map_ = session.brain.experience_map
        self._course, self._session, self._history = course, session, history
        self._began = session.time_s, session.evaluation.path_m, session.simulator.truth
        self._visits = len(course.visits)
        self._known = len(session.brain.local_view), len(map_), len(map_.dropped_links)
        self._false = session.brain.local_view.false_positives
        self._error_m = session.evaluation.errors(map_)[0]
        self._winner: Packet = session.brain.pose_cells.winner
        self._turn = TurnOfCells(course)
        self._event = history.log.events[-1].number if history.log.events else 0
        self._counts = dict.fromkeys(COUNTED, 0)
        self._error_open_m = self._error_now_m = self._error_m
        self._poses = self._before_closure = map_.poses[:, :2].copy()
        self._most, self._rival_s, self._off_most = 0, 0.0, 0.0

    def note(self) -> None:
        session = self._session
        packets = session.brain.pose_cells.packets
        self._most = max(self._most, self._packets())
        if len(packets) > 1 and packets[1].mass > RIVAL:
            self._rival_s += session.frame.dt
        off = self._off()
        self._off_most = self._off_most if math.isnan(off) else max(self._off_most, off)
        self._turn.note()
        for event in reversed(self._history.log.events):
            if event.number <= self._event:
                break
            if event.kind in self._counts:
                self._counts[event.kind] += 1
            if event.kind == "closure":
                self._before_closure, self._error_open_m = self._poses, self._error_now_m
        if self._history.log.events:
            self._event = self._history.log.events[-1].number
        map_ = session.brain.experience_map
        self._poses = map_.poses[:, :2].copy()
        if session.tick_count % ERROR_EVERY == 0:
            self._error_now_m = session.evaluation.errors(map_)[0]

    def values(self) -> Values:
        """All of units.MEASURED; what did not happen is infinite, what cannot be known is NaN."""
        session, map_ = self._session, self._session.brain.experience_map
        evaluation, cells = session.evaluation, session.brain.pose_cells
        error_m, odometry_m = evaluation.errors(map_)
        winner, before = cells.winner, self._winner
        places = Phenomena(self._course).scores()
        layers = math.remainder(winner.heading_rad - before.heading_rad, math.tau) / math.tau * cells.shape[0]
        return {
            "seconds": session.time_s - self._began[0],
            "path_m": evaluation.path_m - self._began[1],
            "error_m": error_m,
            "error_before_m": self._error_m,
            "error_open_m": self._error_open_m,
            "odometry_m": odometry_m,
            "off_m": self._off(),
            "off_most_m": self._off_most,
            "cells_moved": cells.cells_apart(before.x, before.y, winner.x, winner.y),
            "layers_turned": layers,
            "packets_most": float(self._most),
            "packets_end": float(self._packets()),
            "rival_s": self._rival_s,
            "snaps": float(self._counts["snap"]),
            "closures": float(self._counts["closure"]),
            "false_looks": float(session.brain.local_view.false_positives - self._false),
            "bent_m": self._bent_m(),
            "views": float(len(session.brain.local_view)),
            "views_before": float(self._known[0]),
            "views_new": float(len(session.brain.local_view) - self._known[0]),
            "experiences": float(len(map_)),
            "experiences_new": float(len(map_) - self._known[1]),
            "experiences_here": self._here(),
            "multiple": places["multiple_representations"],
            "collisions": places["hash_collisions"],
            "residual_m": map_.residual[0],
            "turn_kept": self._turn.scores().get("turn_kept", math.nan),
            "links_dropped": float(len(map_.dropped_links) - self._known[2]),
            **self._kidnap(),
            **self._goals(),
        }

    def _packets(self) -> int:
        return sum(packet.mass >= SHARE for packet in self._session.brain.pose_cells.packets)

    def _off(self) -> float:
        session = self._session
        return session.evaluation.belief_off(session.simulator.truth, session.brain.experience_map)[0]

    def _bent_m(self) -> float:
        before, now = self._before_closure, self._session.brain.experience_map.poses[:, :2]
        if not self._counts["closure"] or not len(before):
            return 0.0
        moved = now[: len(before)] - before
        return float(np.mean(np.hypot(moved[:, 0], moved[:, 1])))

    def _here(self) -> float:
        session, truth = self._session, self._session.simulator.truth
        births = session.evaluation.births(len(session.brain.experience_map))
        return float(np.sum(np.hypot(births[:, 0] - truth.x, births[:, 1] - truth.y) < HERE_M))

    def _kidnap(self) -> dict[str, float]:
        kidnaps = self._session.evaluation.kidnaps
        last = kidnaps[-1] if kidnaps else None
        found = last is not None and last.after_s is not None
        if last is None or not found:
            return {"found_s": math.inf, "found_m": math.inf}
        return {"found_s": last.after_s or 0.0, "found_m": last.after_m or 0.0}

    def _goals(self) -> dict[str, float]:
        visits = self._course.visits[self._visits :]
        values = {"goals": float(len(visits)), "reached": float(sum(visit.reached for visit in visits))}
        if not visits or not visits[-1].reached:
            return {**values, "goal_s": math.inf, "goal_m": math.inf, "detour": math.inf, "lower_way": math.nan}
        last, path = visits[-1], self._session.evaluation.path
        began = path[min(len(path) - 1, round(last.began_s / self._session.frame.dt))]
        straight = math.dist(began, path[-1])
        return {
            **values, "goal_s": last.time_s, "goal_m": last.path_m, "detour": last.path_m / max(straight, 0.1),
            "lower_way": WayTaken(self._course).scores().get("lower_way", math.nan),
        }  # fmt: skip

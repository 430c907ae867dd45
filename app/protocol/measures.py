"""What can be measured in a course, for experiments and lessons alike: one register, by the names of the readings.

A measure is made when measuring begins, looks at the session after each tick, and gives its readings at the end: those of
everything since it was made. What never happened is infinite; what cannot be known is NaN, or left out. Nothing goes back to
the robot. A new one is a class and its name in `MEASURES`, at the end.
"""

from __future__ import annotations

import difflib
import math
import re
import statistics
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from app.companion import Companion
    from app.evaluation import Evaluation
    from app.protocol.course import Course
    from app.session import Session
    from app.views.history import History
    from ratslam_core import GoalMemory, RatSlam
    from ratslam_core.types import Packet


@dataclass(frozen=True, slots=True)
class Reading:
    """words: what it is; pattern: for its value, as in str.format; never: said when it did not happen (infinite)."""

    words: str
    pattern: str = "{:.0f}"
    never: str = "never"

    def shown(self, value: float) -> str:
        """A value in words."""
        if math.isnan(value):
            return "unknown"
        return self.pattern.format(value) if math.isfinite(value) else self.never


S, M, CM, SHARE = "{:.1f} s", "{:.1f} m", "{:.2f} m", "{:.0%}"  # patterns of readings


class Subject:
    """What is measured: the robot's brain in a course, or the second brain that has the same senses."""

    def __init__(self, course: Course, history: History | None = None, *, second: bool = False) -> None:
        """history: of the session; measures that count its events need it."""
        self.course, self.session, self._history, self._second = course, course.session, history, second

    @property
    def brain(self) -> RatSlam:
        return self._judged.brain

    @property
    def evaluation(self) -> Evaluation:
        return self._judged.evaluation

    @property
    def history(self) -> History:
        if self._history is None:
            raise ValueError("nobody has kept a history of this run")
        return self._history

    @property
    def off_m(self) -> float:
        """Between ground truth and the pose estimate of this brain; NaN where that has no meaning."""
        return self.evaluation.belief_off(self.session.simulator.truth, self.brain.experience_map)[0]

    @property
    def _judged(self) -> Session | Companion:
        if not self._second:
            return self.session
        if self.session.companion is None:
            raise ValueError("the second brain is no longer there")
        return self.session.companion


class Measure(ABC):
    """readings: by name; "N" in a name stands for a number, from 1. always: every trial has it. of_any_brain: it can be
    measured of a second brain, too. costly: measured only where a reading of it is asked for."""

    readings: ClassVar[dict[str, Reading]]
    always: ClassVar[bool] = False
    of_any_brain: ClassVar[bool] = False
    needs_history: ClassVar[bool] = False
    costly: ClassVar[bool] = False

    def __init__(self, subject: Subject) -> None:
        self.subject, self.course, self.session = subject, subject.course, subject.session

    def note(self) -> None:  # noqa: B027 - most look at the end only
        """After each tick."""

    @abstractmethod
    def values(self) -> dict[str, float]: ...


# ------------------------------------------------------------ the run, the map, what was learnt


class Driven(Measure):
    """The way, and how much of it led over known ground."""

    always = True
    readings: ClassVar = {
        "simulated_s": Reading("how long it took, simulated", "{:.0f} s"),
        "path_m": Reading("how far the robot drove in it", M),
        "old_ground": Reading("share of its ways that led where it had been before", SHARE),
        "consistent": Reading("share of its passes within half a metre of an earlier one in the map, too", SHARE),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._began = self.session.time_s, self.session.evaluation.path_m

    def values(self) -> dict[str, float]:
        session, evaluation = self.session, self.session.evaluation
        consistency = evaluation.revisit_consistency
        return {
            "simulated_s": session.time_s - self._began[0],
            "path_m": evaluation.path_m - self._began[1],
            "old_ground": evaluation.revisit_share,
            "consistent": math.nan if consistency is None else consistency,
        }


class MapError(Measure):
    always = of_any_brain = True
    readings: ClassVar = {
        "error_m": Reading("map error at the end, after alignment", CM),
        "error_before_m": Reading("map error before it", CM),
        "odometry_m": Reading("error of odometry alone at the end", CM),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._before_m = subject.evaluation.errors(subject.brain.experience_map)[0]

    def values(self) -> dict[str, float]:
        error_m, odometry_m = self.subject.evaluation.errors(self.subject.brain.experience_map)
        return {"error_m": error_m, "error_before_m": self._before_m, "odometry_m": odometry_m}


class Learnt(Measure):
    """What the brain holds at the end, and how much of it is new."""

    always = of_any_brain = True
    readings: ClassVar = {
        "views": Reading("views known at the end"),
        "views_before": Reading("views known before it"),
        "views_new": Reading("views recruited in it"),
        "experiences": Reading("experiences at the end"),
        "experiences_new": Reading("experiences made in it"),
        "links": Reading("links of the experience map at the end"),
        "links_dropped": Reading("links deleted in it"),
        "snaps": Reading("snaps of the winning packet"),
        "false_positives": Reading("views that were taken for another known one"),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._before = self._sizes()

    def values(self) -> dict[str, float]:
        now, before = self._sizes(), self._before
        new = {name: float(now[name] - before[name]) for name in now}
        return {
            "views": float(now["views"]), "views_before": float(before["views"]), "views_new": new["views"],
            "experiences": float(now["experiences"]), "experiences_new": new["experiences"],
            "links": float(self.subject.brain.experience_map.link_count), "links_dropped": new["dropped"],
            "snaps": new["snaps"], "false_positives": new["false"],
        }  # fmt: skip

    def _sizes(self) -> dict[str, int]:
        brain = self.subject.brain
        return {
            "views": len(brain.local_view),
            "experiences": len(brain.experience_map),
            "dropped": len(brain.experience_map.dropped_links),
            "snaps": brain.relocalisations,
            "false": brain.local_view.false_positives,
        }


class Belief(Measure):
    """Pose estimate against ground truth; consistency over time (A 6.5)."""

    of_any_brain = True
    OFF_M = 0.5
    readings: ClassVar = {
        "off_m": Reading("how far the robot is from where it believes itself to be, at the end", CM),
        "off_most_m": Reading("the same, at worst", CM),
        "astray_m": Reading("how far the robot is from where its map, laid over the office as before it, says", M),
        "longest_off_s": Reading("the longest time that it was more than half a metre off", S),
        "farthest_off_m": Reading("how far off it was then at most", CM),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._map_in_office = subject.evaluation.map_in_office(subject.brain.experience_map)
        self._most_m = self._off_s = self._longest_s = self._farthest_m = 0.0

    def note(self) -> None:
        off_m = self.subject.off_m
        self._most_m = self._most_m if math.isnan(off_m) else max(self._most_m, off_m)
        if math.isnan(off_m) or off_m <= self.OFF_M:
            self._off_s = 0.0
            return
        self._off_s += self.session.frame.dt
        self._longest_s, self._farthest_m = max(self._longest_s, self._off_s), max(self._farthest_m, off_m)

    def values(self) -> dict[str, float]:
        believed = self._map_in_office.compose(self.subject.brain.experience_map.robot)
        return {
            "off_m": self.subject.off_m,
            "off_most_m": self._most_m,
            "astray_m": math.dist(self.course.here, (believed.x, believed.y)),
            "longest_off_s": self._longest_s,
            "farthest_off_m": self._farthest_m,
        }


class Closures(Measure):
    """Closed loops, and what the last of them did to the map."""

    needs_history = True
    ERROR_EVERY = 10  # ticks between two looks at the whole map
    readings: ClassVar = {
        "closures": Reading("closed loops"),
        "error_open_m": Reading("map error shortly before the last closed loop; without one, before what is shown", CM),
        "bent_m": Reading("how far experiences moved in the map, in the mean, from before the last closed loop", CM),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        map_, events = subject.brain.experience_map, subject.history.log.events
        self._event = events[-1].number if events else 0
        self._count = 0
        self._error_open_m = self._error_now_m = subject.evaluation.errors(map_)[0]
        self._poses = self._before = map_.poses[:, :2].copy()

    def note(self) -> None:
        session, map_, events = self.session, self.subject.brain.experience_map, self.subject.history.log.events
        new = takewhile(lambda event: event.number > self._event, reversed(events))
        for _ in [event for event in new if event.kind == "closure"]:
            self._count += 1
            self._before, self._error_open_m = self._poses, self._error_now_m
        self._event = events[-1].number if events else 0
        self._poses = map_.poses[:, :2].copy()
        if session.tick_count % self.ERROR_EVERY == 0:
            self._error_now_m = session.evaluation.errors(map_)[0]

    def values(self) -> dict[str, float]:
        return {"closures": float(self._count), "error_open_m": self._error_open_m, "bent_m": self._bent_m()}

    def _bent_m(self) -> float:
        before, now = self._before, self.subject.brain.experience_map.poses[:, :2]
        if not self._count or not len(before):
            return 0.0
        moved = now[: len(before)] - before
        return float(np.mean(np.hypot(moved[:, 0], moved[:, 1])))


class Residual(Measure):
    """The disagreement of map and links (B 4.3), mean over the links."""

    EVERY = 50  # ticks
    readings: ClassVar = {
        "residual_m": Reading("by how much map and links disagree at the end", "{:.3f} m"),
        "residual_at_most_m": Reading("the same, at worst", "{:.3f} m"),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._most_m = 0.0

    def note(self) -> None:
        if self.session.tick_count % self.EVERY == 0:
            self._most_m = max(self._most_m, self.session.brain.experience_map.residual[0])

    def values(self) -> dict[str, float]:
        residual_m = self.session.brain.experience_map.residual[0]
        return {"residual_m": residual_m, "residual_at_most_m": self._most_m}


class Places(Measure):
    """Places with several representations, and pose cells that stand for several places (B 3.6, 3.7)."""

    HERE_M = 0.5
    readings: ClassVar = {
        "places": Reading("places"),
        "multiple_representations": Reading("places with several representations in the pose cells"),
        "hash_collisions": Reading("states of the pose cells that stand for several places"),
        "experiences_here": Reading("experiences that were made within half a metre of where the robot ends"),
    }

    def values(self) -> dict[str, float]:
        from ratslam_core import find_places

        map_, (x, y) = self.session.brain.experience_map, self.course.here
        found, births = find_places(map_), self.session.evaluation.births(len(map_))
        return {
            "places": float(len(found.first)),
            "multiple_representations": float(len(found.multiple_representations)),
            "hash_collisions": float(len(found.hash_collisions)),
            "experiences_here": float(np.sum(np.hypot(births[:, 0] - x, births[:, 1] - y) < self.HERE_M)),
        }


class Covered(Measure):
    readings: ClassVar = {"covered": Reading("share of the floor to which the robot has come within a metre", SHARE)}

    def values(self) -> dict[str, float]:
        from app.evaluation import Coverage

        session = self.session
        return {"covered": Coverage().follow(session.simulator.free_space, session.evaluation.path)}


class WaysApart(Measure):
    """How far apart the map draws the ways out and back of one place (B 7).

    Two experiences are of one place if they were made within half a metre of each other, facing opposite ways.
    """

    costly = True
    NEAR_M = 0.5
    OPPOSITE_RAD = 2.5
    readings: ClassVar = {
        "ways_apart_m": Reading("how far apart the map draws the ways out and back of one place, in the mean", CM),
        "ways_apart_at_most_m": Reading("the same, at worst", CM),
    }

    def values(self) -> dict[str, float]:
        map_ = self.session.brain.experience_map
        made = self.session.evaluation.births(len(map_))
        known = np.flatnonzero(np.isfinite(made[:, 0]))
        apart: list[float] = []
        for i in known.tolist():
            others = known[known > i]
            near = np.hypot(made[others, 0] - made[i, 0], made[others, 1] - made[i, 1]) < self.NEAR_M
            turn = np.abs(np.remainder(made[others, 2] - made[i, 2] + np.pi, 2 * np.pi) - np.pi)
            pairs = others[near & (turn > self.OPPOSITE_RAD)]
            apart.extend(np.hypot(*(map_.poses[pairs, :2] - map_.poses[i, :2]).T).tolist())
        return {"ways_apart_m": float(np.mean(apart)), "ways_apart_at_most_m": max(apart)} if apart else {}


# ------------------------------------------------------------ the pose cells


class Packets(Measure):
    """Competing packets (A 5)."""

    LEAST = 0.1  # of all activity: a smaller packet is not counted
    RIVAL = 0.2
    readings: ClassVar = {
        "packets_most": Reading("packets with a tenth of the activity, at most"),
        "packets_end": Reading("packets with a tenth of the activity, at the end"),
        "packets_at_most": Reading("packets of any size, at most"),
        "rival_s": Reading("for how long a second packet held a fifth", S),
        "one_won_s": Reading("time from the last kidnap until no rival held a fifth any more, for good", S),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._most = self._any = 0
        self._rival_s = self._last_rival_s = 0.0

    def note(self) -> None:
        packets = self.session.brain.pose_cells.packets
        self._any, self._most = max(self._any, len(packets)), max(self._most, self._large)
        if len(packets) > 1 and packets[1].mass > self.RIVAL:
            self._rival_s += self.session.frame.dt
            self._last_rival_s = self.session.time_s

    def values(self) -> dict[str, float]:
        kidnaps = self.session.evaluation.kidnaps
        won_s = max(0.0, self._last_rival_s - kidnaps[-1].at_s) if kidnaps else math.nan
        return {
            "packets_most": float(self._most), "packets_end": float(self._large), "packets_at_most": float(self._any),
            "rival_s": self._rival_s, "one_won_s": won_s,
        }  # fmt: skip

    @property
    def _large(self) -> int:
        return sum(packet.mass >= self.LEAST for packet in self.session.brain.pose_cells.packets)


class PacketMoved(Measure):
    """How far the winning packet has moved, and how far it is from where the same moves without errors lead (A 4)."""

    readings: ClassVar = {
        "cells_moved": Reading("how far the winning packet moved, in cells", "{:.1f} cells"),
        "layers_turned": Reading("how many layers the winning packet moved, counter-clockwise", "{:+.0f} layers"),
        "end_off_m": Reading("how far it is from where the same moves without errors lead", CM),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._winner, self._truth = self.session.brain.pose_cells.winner, self.session.simulator.truth

    def values(self) -> dict[str, float]:
        cells, before, began = self.session.brain.pose_cells, self._winner, self._truth
        winner, truth = cells.winner, self.session.simulator.truth
        turn, cell_m = before.heading_rad - began.heading_rad, self.session.config.pose_cells.cell_m
        c, s, dx, dy = math.cos(turn), math.sin(turn), truth.x - began.x, truth.y - began.y
        ahead, aside = before.x + (c * dx - s * dy) / cell_m, before.y + (s * dx + c * dy) / cell_m
        layers = math.remainder(winner.heading_rad - before.heading_rad, math.tau) / math.tau * cells.shape[0]
        return {
            "cells_moved": cells.cells_apart(before.x, before.y, winner.x, winner.y),
            "layers_turned": layers,
            "end_off_m": cells.cells_apart(ahead, aside, winner.x, winner.y) * cell_m,
        }


class TurnKept(Measure):
    """How far the packet's path turns in the pose cells for each turn that the robot truly makes (B 5.2).

    1: right; 0: the loop's path is a straight line. Turning to the left and to the right cancel, as they do in a loop.
    """

    readings: ClassVar = {
        "turned_deg": Reading("how far the robot turned in all, counter-clockwise", "{:.0f} degrees"),
        "turned_in_cells_deg": Reading("how far the packet's path turned", "{:.0f} degrees"),
        "turn_kept": Reading("share of the robot's turns that the packet's path keeps", SHARE),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._cells = self._true = 0.0
        self._before: tuple[float, float] | None = None

    def note(self) -> None:
        heading = self.session.brain.pose_cells.winner.heading_rad
        true = self.session.simulator.truth.heading_rad
        if self._before is not None and not self.session.estimate.relocalised:
            self._cells += math.remainder(heading - self._before[0], math.tau)
            self._true += math.remainder(true - self._before[1], math.tau)
        self._before = heading, true

    def values(self) -> dict[str, float]:
        kept = math.nan if abs(self._true) < math.pi else self._cells / self._true
        turned, turned_in_cells = math.degrees(self._true), math.degrees(self._cells)
        return {"turned_deg": turned, "turned_in_cells_deg": turned_in_cells, "turn_kept": kept}


class FalseSnaps(Measure):
    """Snaps (A 6.6): those after which the robot was more than a metre from where it then believed to be."""

    FALSE_M = 1.0
    readings: ClassVar = {
        "false_snaps": Reading("snaps to a place more than a metre from the robot"),
        "true_snaps": Reading("snaps to where the robot was"),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._false = self._true = 0

    def note(self) -> None:
        if not self.session.estimate.relocalised or self.session.estimate.created:
            return
        off_m = self.subject.off_m
        self._false += off_m > self.FALSE_M
        self._true += off_m <= self.FALSE_M

    def values(self) -> dict[str, float]:
        return {"false_snaps": float(self._false), "true_snaps": float(self._true)}


# ------------------------------------------------------------ kidnaps, goals, ways


class Kidnaps(Measure):
    """How the robot found itself again: of all kidnaps, of each, and of the last."""

    always = True
    WRONG_S, WRONG_LONG_S = 0.5, 3.0
    readings: ClassVar = {
        "kidnaps": Reading("kidnaps"),
        "recovered": Reading("kidnaps after which the robot knew again where it was"),
        "wrong": Reading("kidnaps after which it believed a wrong place for half a second"),
        "wrong_long": Reading("kidnaps after which it believed a wrong place for three seconds"),
        "joined": Reading("kidnaps after which its map was one again"),
        "made_consistent": Reading("kidnaps after which its map was consistent again"),
        "kidnap_median_s": Reading("time from a kidnap until the robot knew where it was, median", S),
        "kidnap_N_s": Reading("time from this kidnap until the robot knew where it was", S),
        "kidnap_N_m": Reading("way driven until then", M),
        "kidnap_N_wrong_s": Reading("how long it believed a wrong place at a stretch, at most", S),
        "kidnap_N_joined_s": Reading("time from this kidnap until its map was one again", S),
        "kidnap_N_consistent_s": Reading("time from this kidnap until its map was consistent again", S),
        "found_s": Reading("time from the last kidnap until the robot knew where it was", S),
        "found_m": Reading("way driven until then", M),
    }

    def values(self) -> dict[str, float]:
        kidnaps = self.session.evaluation.kidnaps
        if not kidnaps:
            return {"found_s": math.inf, "found_m": math.inf}
        after = [kidnap.after_s for kidnap in kidnaps if kidnap.after_s is not None]
        values = {
            "kidnaps": float(len(kidnaps)),
            "recovered": float(len(after)),
            "wrong": float(sum(k.wrong.most_s > self.WRONG_S for k in kidnaps)),
            "wrong_long": float(sum(k.wrong.most_s > self.WRONG_LONG_S for k in kidnaps)),
            "joined": float(sum(k.joined_s is not None for k in kidnaps)),
            "made_consistent": float(sum(k.consistent_s is not None for k in kidnaps)),
            "kidnap_median_s": statistics.median(after) if after else math.inf,
            "found_s": _or_never(kidnaps[-1].after_s),
            "found_m": _or_never(kidnaps[-1].after_m),
        }
        for number, kidnap in enumerate(kidnaps, start=1):
            values[f"kidnap_{number}_s"] = _or_never(kidnap.after_s)
            values[f"kidnap_{number}_m"] = _or_never(kidnap.after_m)
            values[f"kidnap_{number}_wrong_s"] = kidnap.wrong.most_s
            values[f"kidnap_{number}_joined_s"] = _or_never(kidnap.joined_s)
            values[f"kidnap_{number}_consistent_s"] = _or_never(kidnap.consistent_s)
        return values


def _or_never(value: float | None) -> float:
    return math.inf if value is None else value


class Goals(Measure):
    """How the visits ended: of all, of each, and of the last."""

    always = True
    readings: ClassVar = {
        "goals": Reading("goals that were given"),
        "reached": Reading("goals that were reached"),
        "goal_N_s": Reading("time to this goal", "{:.0f} s"),
        "goal_N_m": Reading("way to this goal", M),
        "goal_N_miss_m": Reading("how far from this goal it ended", CM),
        "goal_s": Reading("time to the last goal", "{:.0f} s"),
        "goal_m": Reading("way to the last goal", M),
        "detour": Reading("that way over the straight line", "{:.1f}"),
        "lower_way": Reading("share of that way in the lower half of the world", SHARE),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._before = len(self.course.visits)

    def values(self) -> dict[str, float]:
        visits = self.course.visits[self._before :]
        values = {"goals": float(len(visits)), "reached": float(sum(visit.reached for visit in visits))}
        for number, visit in enumerate(visits, start=1):
            values[f"goal_{number}_s"] = visit.time_s
            values[f"goal_{number}_m"] = visit.path_m
            values[f"goal_{number}_miss_m"] = visit.miss_m
        return {**values, **self._last()}

    def _last(self) -> dict[str, float]:
        """C V.D: where the slow way is."""
        session, visits = self.session, self.course.visits[self._before :]
        never = {"goal_s": math.inf, "goal_m": math.inf, "detour": math.inf, "lower_way": math.nan}
        if not visits:
            return never
        last, (_, low, _, high) = visits[-1], session.world.bounds
        way = session.evaluation.path[round(last.began_s / session.frame.dt) :]
        lower = float(np.mean(way[:, 1] < (low + high) / 2)) if len(way) else math.nan
        if not last.reached:
            return {**never, "lower_way": lower}
        path = session.evaluation.path
        straight = math.dist(path[min(len(path) - 1, round(last.began_s / session.frame.dt))], path[-1])
        detour = last.path_m / max(straight, 0.1)
        return {"goal_s": last.time_s, "goal_m": last.path_m, "detour": detour, "lower_way": lower}


class Waited(Measure):
    """For what a lesson waits."""

    readings: ClassVar = {"met_s": Reading("time until what is waited for happened, simulated", S)}

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._began_s = self.session.time_s

    def values(self) -> dict[str, float]:
        return {"met_s": self.course.met_at_s - self._began_s}


class Arbitration(Measure):
    """How far from the next point of the route each movement ends: the one that was chosen, beside those that were free and not
    chosen (D 4.3, figure 4). It looks once a second while the robot follows a route."""

    costly = True
    EVERY_S = 1.0
    readings: ClassVar = {
        "chosen_off_m": Reading("how far from the route's next point the chosen movement ends", CM),
        "others_off_m": Reading("the same of those that were free and not chosen", CM),
    }

    def __init__(self, subject: Subject) -> None:
        super().__init__(subject)
        self._due_s = 0.0
        self._chosen_m: list[float] = []
        self._others_m: list[float] = []

    def note(self) -> None:
        session = self.session
        state = session.pilot.goal_state
        if state is None or state[1] != "tracking" or session.time_s < self._due_s:
            return
        self._due_s = session.time_s + self.EVERY_S
        look, aim = session.pilot.look_at_choice(), session.pilot.aim
        if look is None or aim is None:
            return
        tried = look()
        ends = tried.paths[:, -1]
        away = np.hypot(ends[:, 0] - aim[0], ends[:, 1] - aim[1])
        free = np.isfinite(tried.cost) & (tried.speed > 0)
        if not free.any() or not free[tried.chosen]:
            return
        self._chosen_m.append(float(away[tried.chosen]))
        free[tried.chosen] = False
        self._others_m.extend(away[free].tolist())

    def values(self) -> dict[str, float]:
        if not (self._chosen_m and self._others_m):
            return {}
        chosen, others = math.fsum(self._chosen_m), math.fsum(self._others_m)
        return {"chosen_off_m": chosen / len(self._chosen_m), "others_off_m": others / len(self._others_m)}


class GoalMemoryRoutes(Measure):
    """Goal memories with each of the three weights changed by a fifth learn beside the brain's own, and lead back to where the
    robot began: does the route stay? C IV.C: "insensitive to small changes"."""

    costly = True
    WEIGHTS = ("time_weight", "activity_weight", "distance_weight")
    CHANGES = (0.8, 1.2)
    readings: ClassVar = {
        "route_off_m": Reading("how far a changed memory's route is from the unchanged one, in the mean", CM),
        "route_off_at_most_m": Reading("the same, at worst", CM),
        "route_cells": Reading("cells that the unchanged route is long"),
    }

    def __init__(self, subject: Subject) -> None:
        from ratslam_core import GoalMemory

        super().__init__(subject)
        brain = self.session.brain
        params, shape, cell_m = brain.params.goal_memory, brain.pose_cells.shape, brain.pose_cells.params.cell_m
        changed = [
            replace(params, **{name: by * getattr(params, name)}) for name in self.WEIGHTS for by in self.CHANGES
        ]
        self._memories = [GoalMemory(each, shape, cell_m) for each in (params, *changed)]
        self._home = brain.pose_cells.winner
        self._under_way_s = 0.0

    def note(self) -> None:
        """The same that the brain's own memory is given in `RatSlam.step`."""
        brain, odometry = self.session.brain, self.session.odometry
        leap = (self.session.estimate.relocalised or brain.carried) and not brain.params.goal_memory.over_jumps
        moves = not odometry.still
        self._under_way_s += odometry.dt * moves
        for memory in self._memories:
            if leap:
                memory.interrupt()
            if moves:
                memory.learn(*brain.pose_cells.active, self._under_way_s)

    def values(self) -> dict[str, float]:
        begin = self.session.brain.pose_cells.winner
        base, *others = [_route(memory, begin, self._home) for memory in self._memories]
        off = [_off(route, base) * self._memories[0].cell_m for route in others if len(route) and len(base)]
        if not off:
            return {}
        return {"route_off_m": float(np.mean(off)), "route_off_at_most_m": max(off), "route_cells": float(len(base))}


MOST_STEPS = 1000  # cells that a route may be long


def _route(memory: GoalMemory, begin: Packet, goal: Packet) -> NDArray[np.float64]:
    """The cells (n, 2) that the directions lead through, a cell a step; empty if they do not lead to the goal."""
    from ratslam_core.goal_memory import ARRIVED

    n_y, n_x = memory.shape[1:]
    times = memory.times_to(round(goal.x) % n_x, round(goal.y) % n_y)
    at, cells = begin, [(begin.x, begin.y)]
    for _ in range(MOST_STEPS):
        bearing = memory.direction(times, at)
        if bearing is None:
            break
        at = replace(at, x=(at.x + math.cos(bearing)) % n_x, y=(at.y + math.sin(bearing)) % n_y)
        cells.append((at.x, at.y))
    away = math.hypot(_apart(at.x, goal.x, n_x), _apart(at.y, goal.y, n_y))
    return np.array(cells) if away <= ARRIVED + 1 else np.zeros((0, 2))


def _off(route: NDArray[np.float64], base: NDArray[np.float64]) -> float:
    """The mean distance of a route's cells from the nearest cell of another route."""
    return float(np.mean([np.hypot(*(base - cell).T).min() for cell in route]))


def _apart(a: float, b: float, ring: int) -> float:
    return (a - b + ring / 2) % ring - ring / 2


# ------------------------------------------------------------ the register

MEASURES: tuple[type[Measure], ...] = (
    Driven, MapError, Learnt, Belief, Closures, Residual, Places, Covered, WaysApart, Packets, PacketMoved, TurnKept,
    FalseSnaps, Kidnaps, Goals, Waited, Arbitration, GoalMemoryRoutes,
)  # fmt: skip
MEASURE_OF = {name: kind for kind in MEASURES for name in kind.readings}
_NUMBER = re.compile(r"_([1-9][0-9]{0,6})(?=_)")


def reading_of(name: str) -> Reading:
    """ValueError: nothing is measured by this name; it names the nearest, or all."""
    return measure_of(name).readings[_NUMBER.sub("_N", name)]


def measure_of(name: str) -> type[Measure]:
    """The measure that gives a reading. ValueError as for `reading_of`."""
    kind = MEASURE_OF.get(_NUMBER.sub("_N", name))
    if kind is None or "_N" in name:
        known = sorted(MEASURE_OF)
        near = difflib.get_close_matches(name, known, 1)
        meant = f"did you mean {near[0]!r}? " if near else ""
        raise ValueError(f"nothing is measured by the name {name!r}; {meant}expected one of: {', '.join(known)}")
    return kind


def number_in(name: str) -> int | None:
    """The number in the name of a reading, such as 2 of `goal_2_s`."""
    match = _NUMBER.search(name)
    return None if match is None else int(match[1])


def measures_for(names: Iterable[str]) -> list[type[Measure]]:
    """Those that these readings need, in the order of the register."""
    asked = {measure_of(name) for name in names}
    return [kind for kind in MEASURES if kind in asked]


class Measuring:
    """Some measures of one course. Call `note` after each tick."""

    def __init__(
        self, course: Course, kinds: Iterable[type[Measure]], history: History | None = None, *, second: bool = False
    ) -> None:
        """history: of the session, watched by whoever made it; without one, it is kept here if a measure needs it. second: of
        the second brain."""
        kinds, self._own_history = list(kinds), None
        if history is None and any(kind.needs_history for kind in kinds):
            from app.views.history import History

            history = self._own_history = History(course.session)
        subject = Subject(course, history, second=second)
        self._measures = [kind(subject) for kind in kinds]

    def note(self) -> None:
        if self._own_history is not None:
            self._own_history.watch()
        for measure in self._measures:
            measure.note()

    def values(self) -> dict[str, float]:
        """All readings."""
        return {name: value for measure in self._measures for name, value in measure.values().items()}


def to_markdown() -> str:
    """All readings; this is docs/measures.md."""
    rows = [
        f"| `{name}` | {reading.words} | {'x' if kind.always else ''} | {'x' if kind.of_any_brain else ''} |"
        for kind in MEASURES
        for name, reading in kind.readings.items()
    ]
    return """# What is measured

Made by `ratslam config --measures`. Scores of [experiments](experiments.md) and findings of [lessons](lessons.md) name these
readings. In a lesson they are of what is shown, in an experiment of the whole trial; `N` stands for the number of a visit or a
kidnap, from 1. What never happened is infinite in a lesson, and missing in a trial. *In every trial*: without being asked for.

| name | what it is | in every trial | of a second brain |
|---|---|---|---|
""" + "".join(f"{row}\n" for row in rows)

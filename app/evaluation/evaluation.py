"""The estimate compared with the truth: errors, consistency, kidnaps. The robot never sees it.

Consistency over time, as in ACRA 2004, 6.5: the estimate here against the estimates of earlier passes through here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from app.evaluation.agreement import Path, alignment, rmse, steady_alignment
from disk import kind
from ratslam_core import CellsOnly, ExperienceMap, Odometry, Pose2, wrap_angles
from ratslam_core.types import grown
from sim2d import Truth

REVISIT_AGE_S = 20.0  # an active experience that was made longer ago than this counts as revisited
NEAR_M, NEAR_RAD = 1.0, 0.6
MET_M, MET_RAD = 1.0, 0.5  # a robot that comes this near to where it was before has something to recognise
CONSISTENT_M = 0.5  # a revisit is consistent if ground truth and pose estimate are this near to each other
CONSISTENT_WITHIN_S = 300.0  # of a kidnap; later nobody asks whether the estimate agrees with those of before
MOST_TICKS = 20_000  # before a kidnap, with whose estimates one after it is compared: the work is bounded
EVERY = 5  # rows; at 10 Hz and 0.3 m/s, one in 0.15 m
LEAST_WAY_M = 0.5  # a path with a smaller spread (RMS distance from its middle) does not determine the map's rotation

Points = NDArray[np.float64]  # (n, 2)


@kind("evaluation/3")
class Evaluation:
    """Keeps, tick by tick, what is needed to compare the map with the truth."""

    def __init__(self, known: int = 0) -> None:
        """known: how many experiences the brain brought with it. Where those were truly made is unknown."""
        # True x, y, heading; local pose x, y, heading; odometry alone x, y. It is what grows for ever: so float32.
        self._rows: NDArray[np.float32] = np.zeros((4096, 8), np.float32)
        self._experience = np.zeros(4096, np.int32)
        self._count = 0
        # True x, y, heading and the time at which each experience was made.
        self._made_at = np.full((max(1024, known), 4), np.nan)
        self._odometry = Pose2(0.0, 0.0, 0.0)
        self._revisits = self._consistent = 0
        self.path_m = 0.0
        self.kidnaps: list[Kidnapping] = []

    def record(
        self, time_s: float, truth: Truth, experiences: ExperienceMap, created: bool, odometry: Odometry
    ) -> None:
        """Record one tick. created: whether an experience was made in it."""
        if self._count == len(self._rows):
            self._rows, self._experience = grown(self._rows), grown(self._experience)
        step, turn = odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt
        self._odometry = self._odometry.compose(Pose2(step * math.cos(turn / 2), step * math.sin(turn / 2), turn))
        local = experiences.local_pose
        self._rows[self._count] = (
            truth.x, truth.y, truth.heading_rad, local.x, local.y, local.heading_rad, self._odometry.x, self._odometry.y,
        )  # fmt: skip
        self._experience[self._count] = experiences.active
        self._count += 1
        self.path_m += abs(truth.speed) * odometry.dt
        if created:
            newest = experiences.here
            if newest >= len(self._made_at):
                self._made_at = np.concatenate([self._made_at, np.full_like(self._made_at, np.nan)])
            self._made_at[newest] = truth.x, truth.y, truth.heading_rad, time_s
        self._judge(time_s, truth, experiences, abs(truth.speed) * odometry.dt)

    def kidnapped(self, time_s: float, experiences: ExperienceMap) -> None:
        self.kidnaps.append(Kidnapping(time_s, self.map_in_office(experiences), len(experiences.poses), self._count))

    def made_at(self, experience: int, experiences: ExperienceMap) -> tuple[float, float]:
        """Where the robot truly was when it made this experience (m, office frame). One that the brain brought with it
        is where the map has it, after alignment with the robot's path."""
        x, y = (float(v) for v in self._made_at[experience, :2])
        if math.isfinite(x):
            return x, y
        truth, mapped, _ = self.trajectories(experiences)
        place = steady_alignment(mapped, truth).compose(experiences.pose(experience))
        return place.x, place.y

    def heading_at(self, experience: int) -> float | None:
        """The robot's true heading (rad) when it made this experience; None for one that its brain brought with it."""
        heading = float(self._made_at[experience, 2])
        return heading if math.isfinite(heading) else None

    def births(self, experiences: int) -> NDArray[np.float64]:
        """True x, y (m), heading (rad) and time (s) of making the first experiences, (n, 4); NaN where unknown."""
        known = self._made_at[:experiences]
        unknown = np.full((experiences - len(known), 4), np.nan)
        return np.concatenate([known, unknown])

    @property
    def path(self) -> Path:
        """Where the robot truly was in each tick, (n, 2). A view."""
        return self._rows[: self._count, :2]

    def belief_off(self, truth: Truth, experiences: ExperienceMap) -> tuple[float, float]:
        """The error (m, rad) of the pose estimate relative to the active experience.

        The experience counts as being where it was truly made, so a map that is bent or moves later changes nothing.
        NaN for an experience that the brain brought with it. Without a map (ACRA 2004) the packet is compared with
        where it was when the robot passed here before, NaN on new ground: what the cells hold need not be Cartesian.
        """
        if isinstance(experiences, CellsOnly):
            passes = self._estimates(slice(0, self._count, EVERY), experiences)
            return off_earlier_passes(*passes, _pose(truth), experiences.robot)
        x, y, heading, _ = self._made_at[experiences.active].tolist()
        if math.isnan(x):
            return math.nan, math.nan
        believed = Pose2(x, y, heading).compose(experiences.local_pose)
        turn = abs(math.remainder(believed.heading_rad - truth.heading_rad, math.tau))
        return math.hypot(believed.x - truth.x, believed.y - truth.y), turn

    @property
    def memory_bytes(self) -> int:
        """What this record takes. It grows for ever, whatever the brain does."""
        return self._rows.nbytes + self._experience.nbytes + self._made_at.nbytes

    @property
    def revisit_share(self) -> float:
        """Share of the ticks in which the active experience was an old one."""
        return self._revisits / self._count if self._count else 0.0

    @property
    def revisit_consistency(self) -> float | None:
        """Share of the time on old experiences in which the robot truly was within 0.5 m of its estimate."""
        return self._consistent / self._revisits if self._revisits else None

    def trajectories(self, experiences: ExperienceMap, every: int = 1) -> tuple[Points, Points, Points]:
        """True path, path through the map as it is now, and path by odometry alone; (n, 2) each, not aligned."""
        ticks = slice(0, self._count, every)
        true, mapped = self._estimates(ticks, experiences)
        return true[:, :2], mapped[:, :2], self._rows[ticks, 6:8].astype(np.float64)

    def map_in_office(self, experiences: ExperienceMap, every: int = 1) -> Pose2:
        """The pose of the map's frame in the office: the very fit after which `errors` measures the map. While the path
        is too short to be aligned, by its end."""
        truth, mapped, _ = self.trajectories(experiences, every)
        if math.sqrt(np.var(truth, axis=0).sum()) >= LEAST_WAY_M:
            return alignment(mapped, truth)
        row, pose = self._rows[self._count - 1], experiences.pose(int(self._experience[self._count - 1]))
        return Pose2(*row[:3].tolist()).compose(pose.compose(Pose2(*row[3:6].tolist())).inverse())

    @property
    def odometry(self) -> Pose2:
        """Where the wheels alone put the robot, in the frame of where the record began."""
        return self._odometry

    def odometry_path(self, ticks: int, every: int = 1) -> Path:
        """The places of `odometry` in the last so many ticks, thinned, (n, 2); the newest is the last."""
        last = self._rows[max(0, self._count - ticks) : self._count, 6:8]
        return last[::-1][::every][::-1]

    def began(self, experiences: ExperienceMap) -> tuple[Pose2, Pose2]:
        """Where the record began: the robot's true pose, and its place in the map as the map is now."""
        row, pose = self._rows[0], experiences.pose(int(self._experience[0]))
        return Pose2(*row[:3].tolist()), pose.compose(Pose2(*row[3:6].tolist()))

    def errors(self, experiences: ExperienceMap, every: int = 1) -> tuple[float, float]:
        """RMSE (m) after SE(2) alignment: of the path through the map, and of odometry alone."""
        truth, mapped, odometry = self.trajectories(experiences, every)
        return rmse(mapped, truth), rmse(odometry, truth)

    def _estimates(self, ticks: slice, experiences: ExperienceMap) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """True poses and estimates, in the map as it is now, of these ticks; (n, 3) each."""
        row, pose = self._rows[ticks, :6].astype(np.float64), experiences.poses[self._experience[ticks]]
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        x, y = pose[:, 0] + c * row[:, 3] - s * row[:, 4], pose[:, 1] + s * row[:, 3] + c * row[:, 4]
        return row[:, :3], np.stack([x, y, pose[:, 2] + row[:, 5]], axis=1)

    def _passes_before(
        self, kidnap: Kidnapping, experiences: ExperienceMap
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self._estimates(slice(max(0, kidnap.ticks - MOST_TICKS), kidnap.ticks, EVERY), experiences)

    def _judge(self, time_s: float, truth: Truth, experiences: ExperienceMap, way_m: float) -> None:
        if time_s - self._made_at[experiences.active, 3] > REVISIT_AGE_S:
            off_m, _ = self.belief_off(truth, experiences)
            if not math.isnan(off_m):
                self._revisits += 1
                self._consistent += off_m <= CONSISTENT_M
        for kidnap in self.kidnaps[-1:]:
            if not kidnap.judged:
                self._judge_kidnap(kidnap, time_s, truth, experiences, way_m)

    def _judge_kidnap(
        self, kidnap: Kidnapping, time_s: float, truth: Truth, experiences: ExperienceMap, way_m: float
    ) -> None:
        kidnap.drive(way_m)
        if kidnap.met_s is None and self._meets(kidnap, truth):
            kidnap.met_s = time_s - kidnap.at_s
        kidnap.carried(time_s, experiences.carried or experiences.suspects_kidnap)
        if kidnap.after_s is None:
            kidnap.believes(time_s, self._right(kidnap, truth, experiences))
        if kidnap.consistent_s is None and time_s - kidnap.at_s < CONSISTENT_WITHIN_S:
            passes = self._passes_before(kidnap, experiences)
            kidnap.agrees(time_s, _near(off_earlier_passes(*passes, _pose(truth), experiences.robot)))

    def _meets(self, kidnap: Kidnapping, truth: Truth) -> bool:
        before = self._rows[max(0, kidnap.ticks - MOST_TICKS) : kidnap.ticks : EVERY, :3].astype(np.float64)
        near = np.hypot(before[:, 0] - truth.x, before[:, 1] - truth.y) <= MET_M
        return bool((np.abs(wrap_angles(before[near, 2] - truth.heading_rad)) <= MET_RAD).any())

    def _right(self, kidnap: Kidnapping, truth: Truth, experiences: ExperienceMap) -> bool | None:
        """Whether place and heading of the pose estimate are right; None if the robot is lost, or at a new
        place. Place alone is not enough: a robot turned on the spot has not moved.
        """
        if isinstance(experiences, CellsOnly):
            passes = self._passes_before(kidnap, experiences)
            off = off_same_estimate(*passes, _pose(truth), experiences.robot)
            return None if math.isnan(off[0]) else _near(off)
        if experiences.lost or experiences.active >= kidnap.known:
            return None
        off = self.belief_off(truth, experiences)
        if math.isnan(off[0]):  # the brain brought it: the map says where it is
            robot = kidnap.map_in_office.compose(experiences.robot)
            turn = abs(math.remainder(robot.heading_rad - truth.heading_rad, math.tau))
            off = math.hypot(robot.x - truth.x, robot.y - truth.y), turn
        return _near(off)


def _pose(truth: Truth) -> Pose2:
    return Pose2(truth.x, truth.y, truth.heading_rad)


def _near(off: tuple[float, float]) -> bool:
    return off[0] <= NEAR_M and off[1] <= NEAR_RAD


AWAY_M = 2.0  # an earlier pass ended when the robot was this far away
HERE_M, HERE_RAD = 0.5, 0.6  # a pass that came this near, facing the same way, went through here


def off_earlier_passes(
    true: NDArray[np.float64], estimated: NDArray[np.float64], here: Pose2, estimate: Pose2
) -> tuple[float, float]:
    """How far (m, rad) the estimate is from those of half of the earlier passes, at least. NaN where there was none.

    true, estimated: the robot's poses so far, thinned, (n, 3) each, m and rad, row by row of one time.
    The estimates need not be Cartesian: only the short way from where an earlier pass was counts as straight. Half,
    since among many passes one agrees by chance, and a place may have two representations.
    """
    apart = np.hypot(true[:, 0] - here.x, true[:, 1] - here.y)
    away = np.flatnonzero(apart > AWAY_M)
    passed = slice(0, away[-1] if len(away) else 0)
    turned = np.abs(wrap_angles(true[passed, 2] - here.heading_rad))
    passes = np.flatnonzero((apart[passed] < HERE_M) & (turned < HERE_RAD))
    if not len(passes):
        return math.nan, math.nan
    then = true[passes]
    turn = estimated[passes, 2] - then[:, 2]
    dx, dy = here.x - then[:, 0], here.y - then[:, 1]
    x = estimated[passes, 0] + np.cos(turn) * dx - np.sin(turn) * dy
    y = estimated[passes, 1] + np.sin(turn) * dx + np.cos(turn) * dy
    off = np.hypot(x - estimate.x, y - estimate.y)
    half = int(np.argsort(off, kind="stable")[(len(off) - 1) // 2])
    facing = estimate.heading_rad - here.heading_rad - float(turn[half])
    return float(off[half]), abs(math.remainder(facing, math.tau))


def off_same_estimate(
    true: NDArray[np.float64], estimated: NDArray[np.float64], here: Pose2, estimate: Pose2
) -> tuple[float, float]:
    """How far (m, rad) the robot is from the place that its estimate stands for: where it truly was when its estimate
    was nearest to what it is now. NaN where it never was near. true, estimated: as for `off_earlier_passes`.
    """
    apart = np.hypot(estimated[:, 0] - estimate.x, estimated[:, 1] - estimate.y)
    turned = np.abs(wrap_angles(estimated[:, 2] - estimate.heading_rad))
    alike = np.flatnonzero((apart < HERE_M) & (turned < HERE_RAD))
    if not len(alike):
        return math.nan, math.nan
    then = alike[np.argmin(apart[alike])]
    moved = Pose2(*estimated[then].tolist()).inverse().compose(estimate)
    stands_for = Pose2(*true[then].tolist()).compose(moved)
    turn = abs(math.remainder(stands_for.heading_rad - here.heading_rad, math.tau))
    return math.hypot(stands_for.x - here.x, stands_for.y - here.y), turn


STAY_S = 0.5  # how long something must be so before it counts


@kind("stretch/1")
@dataclass(slots=True)
class Stretch:
    """Since when something has been so, and how long it was at most."""

    since_s: float | None = None
    way_m: float = 0.0  # driven when it began
    most_s: float = 0.0

    def note(self, time_s: float, way_m: float, holds: bool) -> bool:
        """Note one tick. Returns whether it has been so for STAY_S."""
        if not holds:
            self.since_s = None
            return False
        if self.since_s is None:
            self.since_s, self.way_m = time_s, way_m
        self.most_s = max(self.most_s, time_s - self.since_s)
        return time_s - self.since_s >= STAY_S - 1e-9


@kind("kidnapping/3")
@dataclass(slots=True)
class Kidnapping:
    """One kidnap, judged for all engines alike by the pose estimate, from which the robot acts.

    It is right again (`after_s`, `after_m`) when for half a second the estimate is at a known place, and the ground truth
    within 1 m and 0.6 rad of there. `wrong`: for how long the estimate was at a wrong place until then. `joined_s`: its map
    was one again, which only an engine can tell that notices a kidnap. `consistent_s`: what
    ACRA 2004 would call relocalised, the estimate agrees with those of earlier passes through here. `met_s`: it first was
    within 1 m and 0.5 rad of where it had been before.
    """

    at_s: float
    map_in_office: Pose2
    known: int  # experiences that existed before the kidnap
    ticks: int  # before it
    after_s: float | None = None
    after_m: float | None = None
    joined_s: float | None = None
    consistent_s: float | None = None
    met_s: float | None = None
    wrong: Stretch = field(default_factory=Stretch)
    _right: Stretch = field(default_factory=Stretch)
    _agrees: Stretch = field(default_factory=Stretch)
    _noticed: bool = False
    _way_m: float = 0.0

    @property
    def judged(self) -> bool:
        """Whether nothing of it is open any more."""
        return None not in (self.after_s, self.joined_s, self.consistent_s)

    def drive(self, way_m: float) -> None:
        self._way_m += way_m

    def believes(self, time_s: float, right: bool | None) -> None:
        """Whether the known place of the pose estimate is right; None: the robot is lost, or at a new place."""
        if self.after_s is None:
            self.wrong.note(time_s, self._way_m, right is False)
            if self._right.note(time_s, self._way_m, right is True):
                self.after_s, self.after_m = (self._right.since_s or 0.0) - self.at_s, self._right.way_m

    def carried(self, time_s: float, carried: bool) -> None:
        """Whether the brain knows that it was carried, or suspects it, and has not joined its map again."""
        if self._noticed and not carried and self.joined_s is None:
            self.joined_s = time_s - self.at_s
        self._noticed |= carried

    def agrees(self, time_s: float, agrees: bool) -> None:
        """Whether the estimate agrees with those of earlier passes through here."""
        if self.consistent_s is None and self._agrees.note(time_s, self._way_m, agrees):
            self.consistent_s = (self._agrees.since_s or 0.0) - self.at_s

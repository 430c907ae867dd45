"""The experience map: experiences tie pose cells and scenes to places of a map that stays true. ACRA 2006 section 3.

An experience stands for a state of the pose cells (x', y', theta') and a scene V, and has a pose of its own in the map. A
link is a transition that the robot made: distance, bearing and change of facing by odometry, and the time it took.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ratslam_core import map_correction
from ratslam_core.belief import Belief
from ratslam_core.experiences import Experiences
from ratslam_core.params import ExperienceMapParams
from ratslam_core.transitions import Transitions
from ratslam_core.types import IDENTITY, Odometry, Packet, Pose2, Recognition, wrap_angle

CARRIED_M = 100.0  # how well the robot knows where it is after it was carried away
NOWHERE_M = 0.5  # an experience of a view that shows nothing is only known to be somewhere in its zone


class ExperienceMap:
    """Experiences and links. `step` finds or makes the active experience and learns the transition to it."""

    def __init__(self, shape: tuple[int, int, int], cell_m: float, params: ExperienceMapParams | None = None) -> None:
        self.params = params or ExperienceMapParams()
        self.shape, self.cell_m = shape, cell_m
        self._experiences = Experiences(shape)
        self.yaw_bias = 0.0  # rad/s, learnt
        self._turning_s = self._turning_from_latest_s = 0.0
        self.transitions = Transitions()
        self.active = -1
        self._offset = IDENTITY  # the robot in the frame of the active experience when it was seen best
        self._sigma = 0.0  # how well that is known, m
        self._travel = IDENTITY  # odometry since then
        self._belief = Belief()
        self._arrival: _Arrival | None = None
        self._latest = -1  # the experience made last: where it was made is known exactly
        self._from_latest = IDENTITY  # odometry since then
        self._way_m = self._way_from_latest_m = 0.0
        self._since_s = 0.0
        self._driven_m = self._driving_s = 0.0
        self.closures = 0  # links made to experiences that existed before
        self._solved_at = self._closures_at_solve = 0
        self._steps = 0

    # ------------------------------------------------------------ reading

    def __len__(self) -> int:
        return self._experiences.count

    @property
    def link_count(self) -> int:
        return len(self.transitions.row_of)

    @property
    def poses(self) -> NDArray[np.float64]:
        """x, y (m), heading (rad) of every experience in the map, shape (n, 3). A view."""
        return self._experiences.pose[: len(self)]

    @property
    def links(self) -> NDArray[np.int64]:
        """From and to of every link, shape (m, 2)."""
        return self.transitions.ends[self._travelled]

    @property
    def moves(self) -> NDArray[np.float64]:
        """Of every link: dx, dy (m) in the frame of the first experience and change of facing (rad), shape (m, 3)."""
        return self.transitions.move[self._travelled]

    @property
    def link_times(self) -> NDArray[np.float64]:
        """Seconds that each transition takes, shape (m,).

        [ours] Never less than its length in the map takes at the robot's own pace: from the edge of one zone into the next
        it is only a step, and a route over many such would promise to be there in half the time.
        test_experience_map.py::test_no_link_is_quicker_than_the_robot.
        """
        t, rows = self.transitions, self._travelled
        apart = self.poses[t.ends[rows, 1], :2] - self.poses[t.ends[rows, 0], :2]
        pace = self._driving_s / self._driven_m if self._driven_m > 0 else 0.0
        return np.maximum(t.time_s[rows], pace * np.hypot(apart[:, 0], apart[:, 1]))

    @property
    def _travelled(self) -> NDArray[np.int64]:
        return np.flatnonzero(self.transitions.travelled[: self.transitions.count])

    @property
    def local_pose(self) -> Pose2:
        """Where the robot believes to be in the frame of the active experience."""
        return self._belief.local

    @property
    def robot(self) -> Pose2:
        """The robot in the map."""
        return self.pose(self.active).compose(self.local_pose)

    def pose(self, experience: int) -> Pose2:
        """An experience's place in the map."""
        x, y, heading = self._experiences.pose[self._require(experience)]
        return Pose2(float(x), float(y), float(heading))

    def cell_state(self, experience: int) -> tuple[float, float, float, int]:
        """x', y' (cells), theta' (layers) and the scene of one experience."""
        x, y, theta = self._experiences.at[self._require(experience)]
        return float(x), float(y), float(theta), int(self._experiences.view[experience])

    def energy(self, experience: int, packet: Packet, view: int) -> float:
        """How well this state of pose cells and scene fits an experience; at most 2. `Experiences.energy`."""
        return self._experiences.energy(self._require(experience), packet, view, self.params)

    def _require(self, experience: int) -> int:
        if not 0 <= experience < len(self):
            raise ValueError(f"experience must be from 0 to {len(self) - 1}, got {experience!r}")
        return experience

    # ------------------------------------------------------------ learning

    def step(self, packet: Packet, seen: Recognition, odometry: Odometry) -> bool:
        """One step: the robot moved as the odometry says and is now in this state. True when a new experience was made."""
        self._steps += 1
        if self.active < 0:
            self._create(packet, seen.view, IDENTITY)
            return True
        middle = odometry.yaw_rate * odometry.dt / 2
        step = odometry.speed * odometry.dt
        moved = Pose2(step * math.cos(middle), step * math.sin(middle), wrap_angle(2 * middle))
        turning_s = odometry.dt * (odometry.speed != 0 or odometry.yaw_rate != 0)
        self._travel, self._from_latest = self._travel.compose(moved), self._from_latest.compose(moved)
        self._way_m += abs(step)
        self._way_from_latest_m += abs(step)
        self._turning_s += turning_s
        self._turning_from_latest_s += turning_s
        self._since_s += odometry.dt
        self._driven_m += abs(step)
        self._driving_s += odometry.dt * (odometry.speed != 0)
        self._belief.move(moved, self.params.odometry_drift * abs(step))
        best = self._most_energetic(packet, seen.view)
        before, came, sigma = self.active, self._offset.compose(self._travel), self._sigma
        if best < 0:
            self._create(packet, seen.view, self.robot)
            self._learn_link(before, came, sigma)
            self._learn_spine(before)
            return True
        if best != before:
            self._enter(best, packet, seen)
            self._learn_link(before, came, sigma)
        elif self._arrival is not None and self._deviation(seen) < self._sigma:
            self._see_better(seen)
        return False

    def lose_track(self) -> None:
        """[ours] The robot was moved without its wheels: what led here is not a transition, and odometry starts anew.

        test_experience_map.py::test_a_kidnap_makes_no_way.
        """
        self._sigma = self._belief.sigma = CARRIED_M
        self._latest = -1

    def correct(self) -> None:
        """One step of map correction: sweeps in every step, the exact solution now and then while loops close.

        ACRA 2005 eqs. 12-14 by sweeps that divide by the number of links, which cannot diverge. [ours] Sweeps alone lag
        behind a growing map, so their fixed point is computed directly every `solve_every` steps when loops have closed.
        test_map_correction.py::{test_a_sweep_never_raises_the_residual, test_sweeps_and_solution_agree}.
        """
        t, poses = self.transitions, self._experiences.pose[: len(self)]
        for _ in range(self.params.sweeps):
            map_correction.sweep(poses, t.graph, t.ends, t.move, t.believed, self.params.correction)
        due = self.params.solve_every and self._steps - self._solved_at >= self.params.solve_every
        if due and self.closures > self._closures_at_solve:
            self._solve(poses)

    def _solve(self, poses: NDArray[np.float64]) -> None:
        t, rows = self.transitions, slice(self.transitions.count)
        ends, moves, turning = t.ends[rows], t.move[rows], t.turning_s[rows] if self.params.calibrate else None
        t.believed[rows] = t.weight[rows]
        if self.params.robust:
            t.believed[rows] *= map_correction.trust(
                poses, ends, moves, t.weight[rows], t.chain[rows], self.params.odometry_sigma
            )
        more = map_correction.solve(poses, ends, moves, t.believed[rows], turning)
        if turning is not None:
            self.yaw_bias += more
            moves[:, 2] -= more * turning
        self._solved_at, self._closures_at_solve = self._steps, self.closures

    # ------------------------------------------------------------ inside

    def _most_energetic(self, packet: Packet, view: int) -> int:
        return self._experiences.most_energetic(packet, view, self.params, self.robot)

    def _create(self, packet: Packet, view: int, pose: Pose2) -> None:
        self.active = self._experiences.add(packet, view, pose)
        self.transitions.graph.add_node()
        self._offset, self._travel, self._sigma = IDENTITY, IDENTITY, 0.0
        self._belief.local = IDENTITY

    def _enter(self, experience: int, packet: Packet, seen: Recognition) -> None:
        """Make an experience active; the robot may enter its zone beside its centre."""
        dx, dy, dtheta = self._experiences.cells_from(experience, packet)
        facing = self._experiences.at[experience, 2] * 2 * math.pi / self.shape[0]
        c, s = math.cos(facing), math.sin(facing)
        dx, dy = dx * self.cell_m, dy * self.cell_m
        turn = seen.facing_rad if seen.view >= 0 else dtheta * 2 * math.pi / self.shape[0]
        self._offset = Pose2(c * dx + s * dy, -s * dx + c * dy, wrap_angle(turn))
        self._belief.local = self.pose(experience).inverse().compose(self.robot)
        self._travel, self.active, self._sigma = IDENTITY, experience, self._deviation(seen)
        self._belief.see(self._offset, self._sigma)

    def _deviation(self, seen: Recognition) -> float:
        """How far (m) the robot may be from where a view was taken that differs so much."""
        return self.params.anchor_sigma * seen.difference if seen.view >= 0 else NOWHERE_M

    def _see_better(self, seen: Recognition) -> None:
        """[ours] The robot is nearer to where the active experience was made than before: measure the way here anew.

        test_experience_map.py::test_the_best_look_decides_the_transition.
        """
        arrival = self._arrival
        assert arrival is not None
        arrival.came = arrival.came.compose(self._travel)
        self._offset, self._travel = Pose2(0.0, 0.0, seen.facing_rad), IDENTITY
        self._sigma = self._deviation(seen)
        self._belief.see(self._offset, self._sigma)
        self._measure(arrival)

    def _learn_link(self, i: int, came: Pose2, sigma: float) -> None:
        """The transition i -> active took this move and this time; repeats are averaged. ACRA 2006 eqs. 5-6.

        came: the robot in the frame of i as it arrived; sigma: how well its place in i was known.
        """
        j = self.active
        carried = sigma >= CARRIED_M
        row = None if carried else self.transitions.row_of.get((i, j))
        if row is None:
            row = self.transitions.add(i, j, travelled=not carried)
            self.closures += j != len(self) - 1
        self.transitions.take_time(row, self._since_s, self._turning_s)
        sigma = math.hypot(sigma, self.params.odometry_drift * self._way_m)
        self._since_s = self._turning_s = self._way_m = 0.0
        t = self.transitions
        self._arrival = _Arrival(row, t.move[row].copy(), float(t.weight[row]), came, sigma)
        self._measure(self._arrival)

    def _learn_spine(self, before: int) -> None:
        """[ours] What odometry says between an experience and the one made before it, when known ones lie between.

        Only for map correction, never travelled: without it a stretch over known experiences, each known to some
        decimetres only, cuts the rigid chain of odometry, and the map shrinks.
        """
        if self._latest >= 0 and self._latest != before:
            t = self.transitions
            row = t.add(self._latest, self.active, travelled=False)
            weight = self._weight_of(self.params.odometry_drift * self._way_from_latest_m)
            t.measure(row, self._from_latest, weight, t.move[row], 0.0)
            t.take_time(row, 0.0, self._turning_from_latest_s)
        self._latest, self._from_latest = self.active, IDENTITY
        self._way_from_latest_m = self._turning_from_latest_s = 0.0

    def _weight_of(self, sigma: float) -> float:
        """[ours] What a transition counts in map correction: 1 by odometry over a step, less the worse its ends are known.

        With anchor_sigma and odometry_drift 0 every transition counts the same, as in the papers.
        """
        least = self.params.odometry_sigma**2
        return least / (least + sigma**2)

    def _measure(self, arrival: _Arrival) -> None:
        move = arrival.came.compose(self._offset.inverse())
        weight = self._weight_of(math.hypot(arrival.sigma, self._sigma))
        self.transitions.measure(arrival.row, move, weight, arrival.move, arrival.weight)


@dataclass(slots=True)
class _Arrival:
    """The transition that led to the active experience, as long as it may be measured better."""

    row: int
    move: NDArray[np.float64]  # of the row before this passage
    weight: float
    came: Pose2  # the robot in the frame of the experience before, when the active one was seen best
    sigma: float

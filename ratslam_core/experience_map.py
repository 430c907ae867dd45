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
from ratslam_core.confirmation import Confirmation
from ratslam_core.map_reading import MapReading
from ratslam_core.params import ExperienceMapParams
from ratslam_core.transitions import require_behaviour
from ratslam_core.types import IDENTITY, Odometry, Packet, Pose2, Recognition, require_finite, wrap_angle

CARRIED_M = 100.0  # how well the robot knows where it is after it was carried away
WORK_A_STEP = 1e5  # what exact corrections may cost a step on average, in units of `Solution.work`
NOWHERE_M = 0.5  # an experience of a view that shows nothing is only known to be somewhere in its zone


class ExperienceMap(MapReading):
    """Experiences and links. `step` finds or makes the active experience and learns the transition to it."""

    def __init__(self, shape: tuple[int, int, int], cell_m: float, params: ExperienceMapParams | None = None) -> None:
        """shape: layers, cells along y' and x' of the pose cells; cell_m: side of one cell."""
        super().__init__(shape, cell_m, params)
        self.yaw_bias = 0.0  # rad/s, learnt
        self._offset = IDENTITY  # the robot in the frame of the active experience when it was seen best
        self._sigma = 0.0  # how well that is known, m
        self._travel = IDENTITY  # odometry since then
        self._leg = _Leg()  # since the last link was learnt
        self._arrival: _Arrival | None = None
        self._latest = -1  # the experience made last: where it was made is known exactly
        self._from_latest = _Leg()
        self._confirmation = Confirmation()
        self.closures = 0  # links made to experiences that existed before
        self._solved_at = self._closures_at_solve = 0
        self._rest_after_solve = 0.0
        self._steps = 0

    def step(self, packet: Packet, seen: Recognition, odometry: Odometry, behaviour: int = 0) -> bool:
        """One step: the robot moved as the odometry says and is now in this state. True when a new experience was made.

        behaviour: 0 to 15, the local movement that brought it here; links remember it. ValueError for another one, and for
        a packet that is nowhere.
        """
        require_behaviour(behaviour)
        require_finite("packet", packet.x + packet.y + packet.heading_rad)
        self._steps += 1
        if self.active < 0:
            self._create(packet, seen.view, IDENTITY)
            return True
        self._move(odometry)
        best = self._most_energetic(packet, seen.view)
        before, came, sigma = self.active, self._offset.compose(self._travel), self._sigma
        if best < 0:
            self._create(packet, seen.view, self.robot)
            self._learn_link(before, came, sigma, behaviour)
            self._learn_spine(before)
            return True
        if best != before:
            look = self._look(best, packet, seen)
            if self._confirmed(best, look):
                self._enter(best, look, self._deviation(seen))
                self._learn_link(before, came, sigma, behaviour)
        elif self._arrival is not None and self._deviation(seen) < self._sigma:
            self._see_better(seen)
        return False

    def tried(self, i: int, j: int, reached: bool) -> bool:
        """One trial of the way between two experiences, either way round; True when a link was deleted for it.

        [ours] The paper counts every departure under a link's behaviour as a trial (`link_trials_are`), but where many ways
        leave a place, none of them is what the behaviour is expected to bring. Who follows a route knows what it tries.
        test_transitions.py::test_exploring_deletes_nothing_of_what_was_not_tried.
        """
        rows = [self.transitions.row_of.get(ends, -1) for ends in ((i, j), (j, i))]
        deleted = [self._judge(row, reached) for row in rows if row >= 0]
        return any(deleted)

    def lose_track(self) -> None:
        """[ours] The robot was moved without its wheels: what led here is not a transition, and odometry starts anew.

        test_experience_map.py::test_a_kidnap_makes_no_way.
        """
        self._sigma = self._belief.sigma = CARRIED_M
        self._latest = -1

    def correct(self) -> None:
        """One step of map correction: sweeps in every step, the exact solution now and then while loops close.

        ACRA 2005 eqs. 12-14 by sweeps that divide by the number of links, which cannot diverge. [ours] Sweeps alone lag
        behind a growing map, so their fixed point is computed directly every `solve_every` steps when loops have closed; with
        a large map more seldom, so that a step costs the same on average.
        test_map_correction.py::{test_a_sweep_never_raises_the_residual, test_sweeps_and_solution_agree},
        test_experience_map.py::test_a_correction_that_was_hard_is_followed_by_a_long_rest.
        """
        t, poses = self.transitions, self.poses
        ends, moves = t.ends[: t.count], t.move[: t.count]
        for _ in range(self.params.sweeps):
            map_correction.sweep(poses, t.graph, ends, moves, t.believed, self.params.correction)
        rest = max(self.params.solve_every, self._rest_after_solve)
        due = self.params.solve_every and self._steps - self._solved_at >= rest
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
        more, work = map_correction.solve(poses, ends, moves, t.believed[rows], turning)
        if turning is not None:
            self.yaw_bias += more
            moves[:, 2] -= more * turning
        self._solved_at, self._closures_at_solve = self._steps, self.closures
        self._rest_after_solve = work / WORK_A_STEP

    # ------------------------------------------------------------ inside

    def _move(self, odometry: Odometry) -> None:
        middle = odometry.yaw_rate * odometry.dt / 2
        step = odometry.speed * odometry.dt
        moved = Pose2(step * math.cos(middle), step * math.sin(middle), wrap_angle(2 * middle))
        turning_s = odometry.dt * (odometry.speed != 0 or odometry.yaw_rate != 0)
        self._travel = self._travel.compose(moved)
        self._leg.add(moved, abs(step), turning_s, odometry.dt)
        self._from_latest.add(moved, abs(step), turning_s, odometry.dt)
        self._driven_m += abs(step)
        self._driving_s += odometry.dt * (odometry.speed != 0)
        self._belief.move(moved, self.params.odometry_drift * abs(step))

    def _most_energetic(self, packet: Packet, view: int) -> int:
        robot = self.robot if view < 0 else IDENTITY  # who sees something is not asked where it is in the map
        return self._experiences.most_energetic(packet, view, self.params, robot)

    def _look(self, experience: int, packet: Packet, seen: Recognition) -> Pose2:
        """Where the robot is in the frame of an experience: it may enter the zone beside the centre."""
        dx, dy, dtheta = self._experiences.cells_from(experience, packet)
        facing = self.cell_states[experience, 2] * 2 * math.pi / self.shape[0]
        c, s = math.cos(facing), math.sin(facing)
        dx, dy = dx * self.cell_m, dy * self.cell_m
        turn = seen.facing_rad if seen.view >= 0 else None
        if turn is None:  # only the pose cells tell
            turn = dtheta * 2 * math.pi / self.shape[0]
        return Pose2(c * dx + s * dy, -s * dx + c * dy, wrap_angle(turn))

    def _confirmed(self, experience: int, look: Pose2) -> bool:
        """Who knows that it was carried away is surprised by nothing."""
        needed = self.params.confirm_jumps if self._belief.sigma < CARRIED_M else 0
        return self._confirmation.believes(self.robot, self.pose(experience).compose(look), needed)

    def _create(self, packet: Packet, view: int, pose: Pose2) -> None:
        self.active = self._experiences.add(packet, view, pose)
        self.transitions.graph.add_node()
        self._offset, self._travel, self._sigma = IDENTITY, IDENTITY, 0.0
        self._belief.local = IDENTITY

    def _enter(self, experience: int, look: Pose2, sigma: float) -> None:
        """Make an experience active."""
        self._belief.local = self.pose(experience).inverse().compose(self.robot)
        self._offset, self._travel, self.active, self._sigma = look, IDENTITY, experience, sigma
        self._belief.see(look, sigma)

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
        turn = self._belief.local.heading_rad if seen.facing_rad is None else seen.facing_rad
        self._offset, self._travel = Pose2(0.0, 0.0, turn), IDENTITY
        self._sigma = self._deviation(seen)
        self._belief.see(self._offset, self._sigma)
        self._measure(arrival)

    def _learn_link(self, i: int, came: Pose2, sigma: float, behaviour: int) -> None:
        """The transition i -> active took this move and this time; repeats are averaged. ACRA 2006 eqs. 5-6.

        came: the robot in the frame of i as it arrived; sigma: how well its place in i was known.
        """
        j, t, leg = self.active, self.transitions, self._leg
        self._leg = _Leg()
        carried = sigma >= CARRIED_M
        row = None if carried else t.row_of.get((i, j))
        if row is None:
            row = t.add(i, j, travelled=not carried, behaviour=behaviour)
            self.closures += j != len(self) - 1
        t.take_time(row, leg.time_s, leg.turning_s)
        sigma = math.hypot(sigma, self.params.odometry_drift * leg.way_m)
        self._arrival = _Arrival(row, t.move[row].copy(), float(t.weight[row]), came, sigma)
        self._measure(self._arrival)
        if not carried:
            self._count(row, behaviour)

    def _count(self, row: int, behaviour: int) -> None:
        """The robot came this way: a trial of it, and maybe of the others that lead from there. ACRA 2006 3.4, eq. 9."""
        t, failed = self.transitions, []
        if self.params.link_trials_are == "departures":
            departures = t.departures(int(t.ends[row, 0]), behaviour)
            failed = [int(other) for other in departures if other != row]
        for other in failed:
            self._judge(other, False)
        if self.params.link_trials_are == "tried" or t.behaviour[row] == behaviour:
            self._judge(row, True)

    def _judge(self, row: int, reached: bool) -> bool:
        deleted = self.transitions.judge(row, reached, self.params)
        if deleted and self._arrival is not None and self._arrival.row == row:
            self._arrival = None  # nothing more is to be measured
        return deleted

    def _learn_spine(self, before: int) -> None:
        """[ours] What odometry says between an experience and the one made before it, when known ones lie between.

        Only for map correction, never travelled: without it a stretch over known experiences, each known to some
        decimetres only, cuts the rigid chain of odometry, and the map shrinks.
        """
        if self._latest >= 0 and self._latest != before:
            t, leg = self.transitions, self._from_latest
            row = t.add(self._latest, self.active, travelled=False)
            t.measure(row, leg.moved, self._weight_of(self.params.odometry_drift * leg.way_m), t.move[row], 0.0)
            t.take_time(row, 0.0, leg.turning_s)
        self._latest, self._from_latest = self.active, _Leg()

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
class _Leg:
    """What odometry adds up to since some moment."""

    moved: Pose2 = IDENTITY
    way_m: float = 0.0
    turning_s: float = 0.0
    time_s: float = 0.0

    def add(self, moved: Pose2, way_m: float, turning_s: float, dt: float) -> None:
        self.moved = self.moved.compose(moved)
        self.way_m += way_m
        self.turning_s += turning_s
        self.time_s += dt


@dataclass(slots=True)
class _Arrival:
    """The transition that led to the active experience, as long as it may be measured better."""

    row: int
    move: NDArray[np.float64]  # of the row before this passage
    weight: float
    came: Pose2  # the robot in the frame of the experience before, when the active one was seen best
    sigma: float

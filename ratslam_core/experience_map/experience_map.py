"""The experience map: experiences tie states of the pose cells and scenes to places in a consistent map. ACRA 2006 section 3.

An experience stands for a state of the pose cells (x', y', theta') and a scene V, and has a pose of its own in the map. A
link is a transition that the robot made: distance, bearing and change of facing by odometry, and the time it took.

Each step chooses the experience that the robot sees, enters it or makes a new one, and learns the transition. The papers
take the experience with the most energy. What is ours asks, too, whether the robot can be there; if not, evidence has to
say so (`extensions/evidence.py`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from disk import kind
from ratslam_core.experience_map.temporal_map import TemporalMap
from ratslam_core.extensions.evidence import PRIOR, SAME, Belief, Evidence
from ratslam_core.extensions.exact_solver import ExactSolver
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.odometry_edges import NoOdometryEdges, OdometryEdges, inflate_covariance, open_way_m
from ratslam_core.extensions.pose_filter import SNAP, SNAP_RAD, PoseFilter
from ratslam_core.extensions.submaps import Submaps
from ratslam_core.params import EvidenceParams, ExperienceMapParams
from ratslam_core.parts import GeometricVerification, LocalViewPart, Optimiser
from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.pose_graph.relaxation import has_diverged
from ratslam_core.pose_graph.transitions import PreintegratedOdometry, moved_by, require_behaviour
from ratslam_core.types import IDENTITY, Floats, Ints, Odometry, Packet, Pose2, Recognition, require_finite, wrap_angle

MANY = 2000  # experiences, of which a larger map has more places that look alike
CARRIED = 400.0  # cells: how far off the robot may be after it was carried
BLIND = 4.0  # cells: when there is nothing to see, only experiences this near in the map can become active,
BLIND_LEVELS = 10.0  # and such an observation is as uncertain as one that differs by so much


class Senses(NamedTuple):
    """What can be asked of an observation, beside which view it is."""

    views: LocalViewPart | None = None  # which made it out
    verification: GeometricVerification | None = None  # drops the observations that it does not confirm


@kind("experience map/9")
class ExperienceMap(PoseGraph):
    """Experiences, links and a robot among them. `step` finds or makes the active experience and learns the transition to it."""

    def __init__(
        self,
        shape: tuple[int, int, int],
        cell_m: float,
        params: ExperienceMapParams | None = None,
        optimiser: Optimiser | None = None,
        ground: FamiliarGround | NewGround | None = None,
        evidence: EvidenceParams | None = None,
    ) -> None:
        """shape: layers, cells along y' and x' of the pose cells; cell_m: side of one cell."""
        super().__init__(shape, cell_m, params)
        self.optimiser: Optimiser = optimiser or ExactSolver()
        self.ground = ground or NewGround()
        self.transitions.reuses = isinstance(self.ground, FamiliarGround)
        self.evidence = Evidence(evidence or EvidenceParams(), cell_m)
        self.pose_filter = PoseFilter(cell_m)
        self.submaps = Submaps()
        self._temporal_map = TemporalMap(self)
        self._edges = OdometryEdges() if self.params.odometry_edges else NoOdometryEdges()
        self.here = -1  # the experience at which the map is being learnt
        self.carried = False  # it knows that it was carried away and has not found itself again
        self.corrected = 0  # how often evidence proved it elsewhere: carried unnoticed, slipped, merged wrongly
        self.agrees = True  # whether the last observation agreed with where the robot believed itself to be
        self._offset = IDENTITY  # the robot in the frame of the active experience, at the best observation so far
        self._sigma = 0.0  # how far off that may be, m
        self._travel = IDENTITY  # odometry since then
        self._kidnapped = False  # since the active experience was entered: the way from there is no transition
        self._leg = PreintegratedOdometry()  # since the last link was learnt
        self._arrival: _Arrival | None = None

    def step(
        self, packet: Packet, seen: Recognition, odometry: Odometry, behaviour: int = 0, *,
        beats: int = 1, views: LocalViewPart | None = None, verification: GeometricVerification | None = None,
    ) -> bool:  # fmt: skip
        """One step: the robot moved as the odometry says, to this packet and this view. True when a new experience was made.

        behaviour: 0 to 15, the local movement that led here; links remember it. beats: how often it moved so, and for how
        many observations this one counts. views: can be asked for more about what is seen. verification: drops the
        observations that it does not confirm. ValueError for another number, and for a packet whose place or heading is
        not finite.
        """
        require_behaviour(behaviour)
        for name in ("x", "y", "heading_rad"):
            require_finite(f"packet.{name}", getattr(packet, name))
        self.agrees = True
        if self.here < 0:
            self._create(packet, seen.view, IDENTITY)
            return True
        for _ in range(beats):
            self._move(odometry)
        if self.evidence.known and views is not None and seen.view >= 0:
            self.evidence.observe(self, views, self.submaps.current, verification)
        if seen.recruited:
            self.forget_view(seen.view)
        before = self._departure()
        best, observation, seen = self._choose(packet, seen, Senses(views, verification))
        if best < 0 and self.ground.prune():
            return False
        if best < 0:
            self._create(packet, seen.view, self.robot_here)
            driven = self._learn_link(before, behaviour)
            self._edges.made(self.here, driven, self.transitions, self._weight_of_way)
            return True
        if best != before.experience:
            assert observation is not None
            self._enter(best, *observation)
            self._learn_link(before, behaviour)
        elif self._arrival is not None and self._deviation(seen) < self._sigma:
            self._see_better(seen, verification)
        return False

    def move(self, odometry: Odometry) -> None:
        """The robot moved as the odometry says, and nothing is looked at: a part of a step, or a tick between two."""
        if self.here >= 0:
            self._move(odometry)

    def correct(self, beats: int = 1) -> None:
        """A step of map correction in each beat: experiences are moved until links and map agree. ACRA 2006 section 3.3."""
        for _ in range(beats):
            self.steps += 1
            self.optimiser.correct(self)

    def set_params(self, params: ExperienceMapParams, evidence: EvidenceParams) -> None:
        """Take new live parameters while running."""
        self.params, self.evidence.params = params, evidence

    def tried(self, i: int, j: int, reached: bool) -> bool:
        """Count one trial of the links between two experiences, in both directions. True when a link was deleted for it.

        Beside the departures that the paper counts: a robot on a route knows which links it tries.
        """
        rows = [self.transitions.row_of.get(ends, -1) for ends in ((i, j), (j, i))]
        deleted = [self._judge(row, reached) for row in rows if row >= 0]
        return any(deleted)

    def tie(self, i: int, j: int, moved: Pose2, sigma_m: float, *, way: bool = False) -> None:
        """[ours] Something besides views measured where j lies in the frame of i, give or take `sigma_m`: a loop closure.

        way: the robot can drive from one to the other. Lasers (`app/recordings/scans.py`) and `EchoClosures` do that.
        test_scan_ties.py::test_a_scan_ties_an_experience_to_an_old_one_where_it_belongs.
        """
        t = self.transitions
        row = t.add(i, j, travelled=way)
        t.chain[row] = False
        t.measure(row, moved, self._weight_of(sigma_m), t.move[row], 0.0)
        t.take_time(row, 0.0, 0.0)
        self.closures += 1

    def declare_kidnapped(self) -> None:
        """[ours] The robot was carried, not driven: the way here is no transition, and odometry starts afresh.

        test_experience_map_transitions.py::test_a_kidnap_makes_no_way.
        """
        self._kidnapped, self._sigma = True, CARRIED * self.cell_m
        self.pose_filter.forget(CARRIED * self.cell_m)
        self._edges.forget()
        self.ground.forget()
        if self.params.submaps:
            submap, robot = self.submaps.current, self.robot_here
            self.submaps.begin()
            self.evidence.begin(robot, submap, len(self))
        self.carried = True

    def suspect_kidnap(self) -> bool:
        """[ours] Perhaps the robot was carried: it is in doubt. What it maps from now on lies where odometry leads, as a submap
        would that was merged there at low odds, and can be taken back as one.

        False if the map cannot find that out: it has no submaps, or the robot is lost already.
        test_evidence.py::test_who_was_perhaps_carried_maps_on_and_is_moved_when_it_was.
        """
        if self.carried or not self.params.submaps:
            return False
        self.evidence.end()
        self.evidence.doubt(len(self))
        self.submaps.suspect(len(self), -PRIOR)
        return True

    def declare_found(self) -> None:
        """[ours] The robot that was carried knows again where it is."""
        self.carried = False

    def forget_view(self, view: int) -> None:
        """The view is no more: its experiences stay in the map as places where there is nothing to see."""
        self._experiences.forget_view(view)

    # ------------------------------------------------------------ where the robot is

    @property
    def active(self) -> int:
        """The experience at which the robot believes itself to be."""
        belief = self.belief
        return self.here if belief is None else belief.experience

    @property
    def local_pose(self) -> Pose2:
        """Where the robot believes itself to be, in the frame of the active experience."""
        belief = self.belief
        return self.pose_filter.local if belief is None else self.pose(belief.experience).inverse().compose(belief.pose)

    @property
    def robot(self) -> Pose2:
        """Where the robot believes itself to be, in the map."""
        belief = self.belief
        return self.robot_here if belief is None else belief.pose

    @property
    def robot_here(self) -> Pose2:
        """Where the robot is on its submap."""
        return self.pose(self.here).compose(self.pose_filter.local)

    @property
    def off_m(self) -> float:
        """How far off the robot may be where it maps; inf if nothing tells, by the rules of the papers."""
        return self.pose_filter.sigma_m if self.params.anchor_sigma > 0 else math.inf

    @property
    def lost(self) -> bool:
        """Whether the robot knows that it was carried away, and believes no place."""
        return self.carried and self.evidence.belief is None

    @property
    def suspects_kidnap(self) -> bool:
        """Whether the robot is in doubt since an alarm that may be false."""
        merges = self.submaps.merges
        return bool(merges) and self.evidence.in_doubt and self.evidence.known == merges[-1].first

    @property
    def belief(self) -> Belief | None:
        """Where on the map the robot believes itself to be, if not where it maps; None if there, or nowhere."""
        return self.evidence.belief if self.carried or self.evidence.in_doubt else None

    @property
    def temporal_map(self) -> TemporalMap:
        """Times and routes over the current links; the same object for as long as the map lives."""
        return self._temporal_map

    @property
    def diverged(self) -> bool:
        """Whether correction with the sweep "all at once" has thrown the map apart: `relaxation.sweep_all_at_once`."""
        return self.params.sweep == "all at once" and has_diverged(self.poses, self.moves)

    def _move(self, odometry: Odometry) -> None:
        moved, way_m = moved_by(odometry), abs(odometry.speed * odometry.dt)
        self._travel = self._travel.compose(moved)
        self._leg.add(moved, odometry)
        self.evidence.move(odometry)
        self.submaps.move(way_m / self.cell_m, self.evidence.params.unnoticed)
        self._edges.move(moved, odometry)
        self._driven_m += way_m
        self._driving_s += odometry.dt * (odometry.speed != 0)
        self.pose_filter.move(moved, self.params.odometry_drift * way_m)

    # ------------------------------------------------------------ choosing

    def _choose(
        self, packet: Packet, seen: Recognition, by: Senses
    ) -> tuple[int, tuple[Pose2, float] | None, Recognition]:
        """The experience that the robot is at, -1 for none; the observation and how far off that may be, if it is another than
        before and was seen; and as what it is seen.
        """
        # On familiar ground there is something to see, so the experiences of nothing do not count.
        best, seen = (-1, seen) if seen.familiar else self._seen_experience(packet, seen, by)
        by_place = self.ground.of_view(self, seen.view) if best < 0 else -1
        if max(best, by_place) in (-1, self.here):
            return max(best, by_place), None, seen
        told = self._observation(best, packet, seen) if best >= 0 else self._observation_by_view(by_place, seen)
        observation = self._measured(max(best, by_place), told, seen, by.verification)
        return -1 if observation is None else max(best, by_place), observation, seen

    def log_prior(self, experience: int, pose: Pose2) -> float:
        """Log odds of a place, before anything speaks for it: how far odometry may have led astray since the robot was there,
        or how sure it was not carried unnoticed, or merged where it was not.
        """
        if not self.evidence.in_doubt or self.submap_of[experience] != self.submaps.current:
            return PRIOR
        return -min(self._against_drift(experience, pose), self._against_error(experience))

    @property
    def log_prior_of_new(self) -> float:
        """Log odds, while in doubt, that the robot was carried to a new place, or that what it maps was merged wrongly."""
        merge = self.submaps.least_sure()
        return -min(self.evidence.params.unnoticed, math.inf if merge is None else merge.log_odds)

    def _against_drift(self, experience: int, pose: Pose2, precise_m: float = 0.0) -> float:
        """precise_m: how precisely the pose is known."""
        drift = self.params.odometry_drift * open_way_m(self.transitions, experience, len(self))
        sigma = max(math.hypot(self.pose_filter.sigma_m, drift, precise_m), 1e-9)
        return 0.5 * (self._off(pose) / sigma) ** 2

    def _against_error(self, experience: int) -> float:
        merge = self.submaps.least_sure(experience)
        # To have been carried to this one of many places is the less likely, the more there are.
        unnoticed = self.evidence.params.unnoticed + max(0.0, math.log(len(self) / MANY))
        return unnoticed if merge is None else min(merge.log_odds, unnoticed)

    def _off(self, pose: Pose2) -> float:
        return math.hypot(pose.x - self.robot_here.x, pose.y - self.robot_here.y)

    def _seen_experience(self, packet: Packet, seen: Recognition, by: Senses) -> tuple[int, Recognition]:
        """The experience that the robot sees, the most energetic of those that it can see, -1 for none; and as what.

        [ours] One outside the validation gate puts it in doubt. When evidence has won, it is one beyond the gate, perhaps on
        another submap, and the two were merged.
        """
        if not self.params.submaps:
            return self._most_energetic(packet, seen.view, math.inf), seen
        if self.evidence.known and (merged := self._merged(by)) is not None:
            return merged
        if self._merge_disproved:
            self._take_back_merge()
        elif self.evidence.over(self):
            self._end_of_doubt(self.evidence.here - self.log_prior_of_new)
        gate = self._gate_m
        best = self._most_energetic(packet, seen.view, gate)
        if seen.view < 0 or not self.params.match_view or math.isinf(gate):
            return best, seen
        turns = best >= 0 and self._turns(best, packet, seen)
        if not turns and (best >= 0 or self._may_be_seen_from(seen.view, gate)):
            return best, seen
        if not self.carried:
            self.evidence.doubt(len(self))
        return -1, seen

    @property
    def _gate_m(self) -> float:
        """The validation gate: that odometry led the robot farther astray is less likely than that it was carried."""
        return max(SNAP * self.cell_m, math.sqrt(2 * self.evidence.params.unnoticed) * self.pose_filter.sigma_m)

    def _turns(self, experience: int, packet: Packet, seen: Recognition) -> bool:
        """[ours] The same gate for the heading: whether an observation would turn the robot farther than that can be off.

        test_evidence.py::test_an_observation_that_turns_the_robot_is_outside_the_validation_gate.
        """
        claimed = self.pose(experience).compose(self._observation(experience, packet, seen))
        turn = wrap_angle(claimed.heading_rad - self.robot_here.heading_rad)
        return not self.carried and abs(turn) > SNAP_RAD

    def _may_be_seen_from(self, view: int, gate_m: float) -> bool:
        """Whether an experience of this view lies within the gate, wherever the packet is; or there is none at all."""
        found = self._experiences.of_view(view)
        own = found[self.submap_of[found] == self.submaps.current]
        return not len(own) or bool(self._away(own, self.robot_here).min() <= gate_m)

    def _away(self, which: Ints, pose: Pose2) -> Floats:
        return np.hypot(self.poses[which, 0] - pose.x, self.poses[which, 1] - pose.y)

    def _most_energetic(self, packet: Packet, view: int, gate_m: float) -> int:
        return self._experiences.most_energetic(
            packet, view, self.params, self.robot_here, BLIND * self.cell_m, gate_m, self.submaps.current
        )

    def _merged(self, by: Senses) -> tuple[int, Recognition] | None:
        """The experience that the robot is at, and as what it sees it, if the evidence for that place is so strong that the
        loop is closed or the submap is merged there; it then is. None if not.
        """
        belief = self.evidence.belief
        if belief is None or belief.log_odds < self.evidence.params.merge or by.views is None:
            return None
        observation = self.pose(belief.experience).inverse().compose(belief.pose)
        if by.verification is not None and by.verification.verified(self, belief.experience, observation) is None:
            return None
        view, other = int(self.views[belief.experience]), int(self.submap_of[belief.experience])
        if other == self.submaps.current and self._led_astray(belief):
            self._correct_error(belief)
        if other != self.submaps.current:
            self.submaps.merge(other, self.submap_of, self.poses, self.robot_here, belief.pose, belief.log_odds)
        self._end_of_doubt(belief.log_odds)
        self.carried = False
        return belief.experience, Recognition(view, False, view, by.views.difference_to(view), belief.facing_rad)

    def _led_astray(self, belief: Belief) -> bool:
        """[ours] Whether the robot is where odometry cannot have led it, and not just where a hypothesis is a little off.

        test_evidence.py::test_a_hypothesis_that_is_a_little_off_is_no_proof_against_odometry.
        """
        against = self._against_drift(belief.experience, belief.pose, SAME * self.cell_m)
        return against >= self._against_error(belief.experience)

    def _correct_error(self, belief: Belief) -> None:
        """An earlier merge was wrong, or the robot was carried unnoticed."""
        self.corrected += not self.suspects_kidnap
        merge = self.submaps.least_sure(belief.experience)
        if merge is not None and self.here >= merge.first:
            self._part(merge.first)
        else:
            off, sigma = self._off(belief.pose), self.step_sigma_m
            inflate_covariance(self.transitions, belief.experience, self.evidence.known, off, sigma)

    @property
    def _merge_disproved(self) -> bool:
        """[ours] Whether the robot is surely not where it was merged, wherever else it may be.

        test_evidence.py::test_a_merge_is_disproved_by_what_is_missing_there.
        """
        doubted = self.evidence.in_doubt and bool(self.submaps.merges)
        return doubted and self.evidence.here < self.log_prior_of_new - self.evidence.params.believe

    def _take_back_merge(self) -> None:
        """What it has mapped since is a submap again."""
        merge = self.submaps.least_sure()
        assert merge is not None
        if self.here < merge.first:
            self.declare_kidnapped()
            return
        self.evidence.disprove(self, self.submaps.current)
        self._part(merge.first)
        self.ground.forget()
        self.carried = True

    def _part(self, first: int) -> None:
        self.submaps.part(first, self.submap_of, self.transitions)
        self._arrival = None

    def _end_of_doubt(self, log_odds: float) -> None:
        """[ours] log_odds: that the robot is where it maps from now on. What it mapped before an alarm says so, and counts.

        test_evidence.py::test_an_alarm_that_was_false_leaves_the_map_as_sure_as_before.
        """
        if self.suspects_kidnap:
            self.submaps.confirm(log_odds)
        self.evidence.end(len(self) if np.any(self.submap_of != self.submaps.current) else 0)

    def _measured(
        self, experience: int, observation: Pose2, seen: Recognition, verification: GeometricVerification | None
    ) -> tuple[Pose2, float] | None:
        """[ours] The observation and how far off it may be (m); as geometric verification measures it, None if it fails.

        test_scan_ties.py::test_the_map_asks_for_geometric_verification.
        """
        sigma = self._deviation(seen)
        if verification is None:
            return observation, sigma
        verified = verification.verified(self, experience, observation)
        return verified and (verified[0], sigma if math.isinf(verified[1]) else verified[1])

    def _observation(self, experience: int, packet: Packet, seen: Recognition) -> Pose2:
        """The robot's pose in the frame of an experience, whose zone it may enter beside the centre."""
        if not self.params.zone_offset:
            return IDENTITY
        if self.energy(experience, packet, seen.view) <= self.params.threshold:  # recognised by its view alone
            return Pose2(0.0, 0.0, seen.facing_rad or 0.0)
        told = self._told_by_cells(experience, packet)
        turn = seen.facing_rad if seen.view >= 0 else None
        return told if turn is None else Pose2(told.x, told.y, wrap_angle(turn))

    def _told_by_cells(self, experience: int, packet: Packet) -> Pose2:
        """The robot's pose in the frame of an experience, by the pose cells alone."""
        dx, dy, dtheta = self._experiences.cells_from(experience, packet)
        facing = self.cell_states[experience, 2] * 2 * math.pi / self.shape[0]
        c, s = math.cos(facing), math.sin(facing)
        dx, dy = dx * self.cell_m, dy * self.cell_m
        return Pose2(c * dx + s * dy, -s * dx + c * dy, wrap_angle(dtheta * 2 * math.pi / self.shape[0]))

    def _deviation(self, seen: Recognition) -> float:
        """How far (m) the robot may be from where the view was taken: the more the view differs, the farther."""
        return self.params.anchor_sigma * (seen.difference if seen.view >= 0 else BLIND_LEVELS)

    def _observation_by_view(self, experience: int, seen: Recognition) -> Pose2:
        """[ours] The same without the pose cells: the robot is where the view was taken. See `FamiliarGround.of_view`."""
        turn = seen.facing_rad
        if turn is None:
            turn = self.pose(experience).inverse().compose(self.robot_here).heading_rad
        return Pose2(0.0, 0.0, turn)

    # ------------------------------------------------------------ entering and learning

    def _departure(self) -> _Departure:
        return _Departure(self.here, self._offset.compose(self._travel), self._sigma, self._kidnapped)

    def _create(self, packet: Packet, view: int, pose: Pose2) -> None:
        self.here = self._experiences.add(packet, view, pose, self.submaps.current)
        self.transitions.graph.add_node()
        landed = self._kidnapped and self.params.submaps  # on a submap of its own the robot knows where it is
        self.pose_filter.make(sure=landed)
        self._offset, self._travel, self._sigma, self._kidnapped = IDENTITY, IDENTITY, 0.0, False

    def _enter(self, experience: int, observation: Pose2, sigma: float) -> None:
        """Make a known experience active."""
        self._edges.observe()
        self.pose_filter.local = self.pose(experience).inverse().compose(self.robot_here)
        self._offset, self._travel, self._sigma, self._kidnapped = observation, IDENTITY, sigma, False
        self.here = experience
        self.agrees = self.pose_filter.see(observation, sigma)

    def _see_better(self, seen: Recognition, verification: GeometricVerification | None) -> None:
        """[ours] The robot is nearer than before to where the active experience was made: measure the transition again.

        test_experience_map_transitions.py::test_the_best_observation_decides_the_transition.
        """
        arrival = self._arrival
        assert arrival is not None
        turn = self.pose_filter.local.heading_rad if seen.facing_rad is None else seen.facing_rad
        measured = self._measured(self.here, Pose2(0.0, 0.0, turn), seen, verification)
        if measured is None or measured[1] >= self._sigma:
            return
        arrival.came = arrival.came.compose(self._travel)
        (self._offset, self._sigma), self._travel = measured, IDENTITY
        self._kidnapped = False
        self.agrees = self.pose_filter.see(self._offset, self._sigma)
        self._measure(arrival)

    def _learn_link(self, before: _Departure, behaviour: int) -> int:
        """Learn move and time of the transition to the active experience, and return its row, -1 for none. Repeats are averaged.
        ACRA 2006 eqs. 5-6."""
        i, j, t, leg = before.experience, self.here, self.transitions, self._leg
        self._leg = PreintegratedOdometry()
        row = None if before.kidnapped else t.row_of.get((i, j))
        if row is None and not before.kidnapped and self.ground.well_tied(t, i, j):
            self._arrival = None  # nothing is learnt, so there is nothing to measure better
            return -1
        if row is None:
            row = t.add(i, j, travelled=not before.kidnapped, behaviour=behaviour)
            self.closures += j != len(self) - 1
        t.take_time(row, leg.time_s, leg.turning_s)
        sigma = math.hypot(before.sigma, self.params.odometry_drift * leg.way_m)
        arrival = _Arrival(row, t.move[row].copy(), float(t.weight[row]), before.came, sigma)
        backbone = self.params.odometry_edges and bool(t.chain[row]) and t.passages[row] > 1
        self._arrival = arrival if self.params.best_observation and not backbone else None
        if not backbone:
            self._measure(arrival)
        if not before.kidnapped:
            self._count(row, behaviour)
        return row

    def _count(self, row: int, behaviour: int) -> None:
        """Every departure under a link's behaviour is a trial of it, which succeeds for the link driven. ACRA 2006 3.4, eq. 9."""
        for other in self.transitions.departures(int(self.transitions.ends[row, 0]), behaviour).tolist():
            self._judge(other, other == row)

    def _judge(self, row: int, reached: bool) -> bool:
        deleted = self.transitions.judge(row, reached, self.params)
        if deleted and self._arrival is not None and self._arrival.row == row:
            self._arrival = None  # there is no link left to measure
        return deleted

    def _weight_of_way(self, way_m: float) -> float:
        return self._weight_of(self.params.odometry_drift * way_m)

    def _weight_of(self, sigma: float) -> float:
        """[ours] The weight of a transition in map correction, its inverse covariance: 1 for odometry over one step, less when
        its ends are less certain.

        With anchor_sigma and odometry_drift 0 every transition has the same weight, as in the papers.
        """
        least = self.step_sigma_m**2
        return least / (least + sigma**2)

    def _measure(self, arrival: _Arrival) -> None:
        move = arrival.came.compose(self._offset.inverse())
        weight = self._weight_of(math.hypot(arrival.sigma, self._sigma))
        self.transitions.measure(arrival.row, move, weight, arrival.move, arrival.weight)


@dataclass(frozen=True, slots=True)
class _Departure:
    """Where a transition begins."""

    experience: int
    came: Pose2  # the robot in the frame of that experience as it arrived at the next
    sigma: float  # how far off its place in that frame may be, m
    kidnapped: bool


@kind("arrival/1")
@dataclass(slots=True)
class _Arrival:
    """The transition that led to the active experience, kept as long as a better observation may measure it again."""

    row: int
    move: Floats  # of the row before this passage
    weight: float  # of the row before this passage
    came: Pose2  # the robot in the frame of the experience before, at the best observation of the active one
    sigma: float

"""Looks: which experience the robot sees, where that puts it, and whether it can be. ACRA 2006 section 3.1.

A look is a state of the pose cells and a scene. The papers take the experience with the most energy. What is ours
asks, too, whether the robot can be there; if not, evidence has to say so (`extensions/evidence.py`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ratslam_core.experience_map.temporal_map import TemporalMap
from ratslam_core.extensions.evidence import PRIOR, Belief, Evidence
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.islands import Islands
from ratslam_core.extensions.pose_filter import pose_estimate
from ratslam_core.extensions.torn import open_way_m, soften
from ratslam_core.params import EvidenceParams, ExperienceMapParams, MemoryParams, PoseFilterParams
from ratslam_core.parts import LocalViewPart, Witness
from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.pose_graph.relaxation import has_diverged
from ratslam_core.types import IDENTITY, Packet, Pose2, Recognition, wrap_angle


class Senses(NamedTuple):
    """What can be asked of a sight, beside which view it is."""

    views: LocalViewPart | None = None  # which made it out
    witness: Witness | None = None  # a look that it does not confirm is none


class Looks(PoseGraph):
    """A pose graph and a robot in it that knows what it sees."""

    def __init__(
        self,
        shape: tuple[int, int, int],
        cell_m: float,
        params: ExperienceMapParams | None = None,
        filter_params: PoseFilterParams | None = None,
        ground: FamiliarGround | NewGround | None = None,
        evidence: EvidenceParams | None = None,
    ) -> None:
        super().__init__(shape, cell_m, params)
        self.ground = ground or NewGround(MemoryParams())
        self.here = -1  # the experience at which the map is being learnt
        self.evidence = Evidence(evidence or EvidenceParams())
        self.pose_filter = pose_estimate(filter_params or PoseFilterParams())
        self._temporal_map = TemporalMap(self)
        self.islands = Islands()
        self.carried = False  # it knows that it was carried away and has not found itself again
        self.corrected = 0  # how often evidence proved that it was carried unnoticed, or its wheels slipped

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
    def lost(self) -> bool:
        """Whether the robot knows that it was carried away, and believes no place."""
        return self.carried and self.evidence.belief is None

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

    def log_prior(self, experience: int, pose: Pose2) -> float:
        """Log odds of a place, before anything speaks for it: how far odometry may have led astray since the robot was there."""
        if not self.evidence.in_doubt or self.island_of[experience] != self.islands.current:
            return PRIOR
        drift = self.params.odometry_drift * open_way_m(self.transitions, experience, len(self))
        sigma = max(math.hypot(self.pose_filter.sigma_m, drift), 1e-9)
        return -min(0.5 * (self._off(pose) / sigma) ** 2, self.evidence.params.unnoticed)

    def _off(self, pose: Pose2) -> float:
        return math.hypot(pose.x - self.robot_here.x, pose.y - self.robot_here.y)

    def _seen_experience(self, packet: Packet, seen: Recognition, by: Senses) -> tuple[int, Recognition]:
        """The experience that the robot sees, the most energetic of those that it can see, -1 for none; and as what.

        [ours] One where it cannot be puts it in doubt. When evidence has won, it is one beyond reach, perhaps on another
        submap, and the two were merged.
        """
        if not self.params.islands:
            return self._most_energetic(packet, seen.view, math.inf), seen
        if self.evidence.known and (merged := self._merged(by)) is not None:
            return merged
        if self.evidence.idle:
            self._end_of_doubt()
        reach = self._reach_m
        best = self._most_energetic(packet, seen.view, reach)
        if seen.view < 0 or not self.params.match_view or math.isinf(reach):
            return best, seen
        turns = best >= 0 and self._turns(best, packet, seen)
        if not turns and (best >= 0 or self._may_be_seen_from(seen.view, reach)):
            return best, seen
        if not self.carried:
            self.evidence.doubt(len(self))
        return -1, seen

    @property
    def _reach_m(self) -> float:
        p = self.pose_filter.params
        return max(p.snap_m, p.gate_sigma * self.pose_filter.sigma_m)

    def _turns(self, experience: int, packet: Packet, seen: Recognition) -> bool:
        """[ours] Whether a look would turn the robot farther than its heading can be off, wherever it puts it.

        test_evidence.py::test_a_look_that_turns_the_robot_is_held_back.
        """
        most = self.pose_filter.params.gate_rad
        if most >= math.pi or self.carried:
            return False
        claimed = self.pose(experience).compose(self._look(experience, packet, seen))
        return abs(wrap_angle(claimed.heading_rad - self.robot_here.heading_rad)) > most

    def _may_be_seen_from(self, view: int, reach_m: float) -> bool:
        """Whether an experience of this view lies within reach, wherever the packet is; or there is none at all."""
        found = self._experiences.of_view(view)
        own = found[self.island_of[found] == self.islands.current]
        return not len(own) or bool(self._away(own, self.robot_here).min() <= reach_m)

    def _away(self, which: NDArray[np.int64], pose: Pose2) -> NDArray[np.float64]:
        return np.hypot(self.poses[which, 0] - pose.x, self.poses[which, 1] - pose.y)

    def _most_energetic(self, packet: Packet, view: int, reach_m: float) -> int:
        return self._experiences.most_energetic(
            packet, view, self.params, self.robot_here, reach_m, self.islands.current
        )

    def _merged(self, by: Senses) -> tuple[int, Recognition] | None:
        """The experience that the robot is at, and as what it sees it, if the evidence for that place is so strong that the
        loop is closed or the submap is merged there; it then is. None if not.
        """
        belief = self.evidence.belief
        if belief is None or belief.log_odds < self.evidence.params.merge or by.views is None:
            return None
        look = self.pose(belief.experience).inverse().compose(belief.pose)
        if by.witness is not None and by.witness.confirms(self, belief.experience, look) is None:
            return None
        view, other = int(self.views[belief.experience]), int(self.island_of[belief.experience])
        if other != self.islands.current:
            self.islands.join(other, self.island_of, self.poses, self.robot_here, belief.pose)
        elif self.log_prior(belief.experience, belief.pose) <= -self.evidence.params.unnoticed:
            self.corrected += 1
            off, sigma = self._off(belief.pose), self.params.odometry_sigma
            soften(self.transitions, belief.experience, self.evidence.known, off, sigma)
        self._end_of_doubt()
        self.carried = False
        return belief.experience, Recognition(view, False, view, by.views.difference_to(view), belief.facing_rad)

    def _end_of_doubt(self) -> None:
        self.evidence.end(len(self) if np.any(self.island_of != self.islands.current) else 0)

    def _measured(
        self, experience: int, packet: Packet, seen: Recognition, witness: Witness | None
    ) -> tuple[Pose2, float] | None:
        """[ours] The look, and how far off it may be (m); as a witness measures it, None if it does not confirm it.

        test_scan_ties.py::test_the_map_asks_the_witness.
        """
        look, sigma = self._look(experience, packet, seen), self._deviation(seen)
        confirmed = (look, math.inf) if witness is None else witness.confirms(self, experience, look)
        return (look, sigma) if confirmed is not None and math.isinf(confirmed[1]) else confirmed

    def _look(self, experience: int, packet: Packet, seen: Recognition) -> Pose2:
        """The look: the robot's pose in the frame of an experience, whose zone it may enter beside the centre."""
        if not self.params.zone_offset:
            return IDENTITY
        if self.energy(experience, packet, seen.view) <= self.params.threshold:  # recognised by its view alone
            return Pose2(0.0, 0.0, seen.facing_rad or 0.0)
        dx, dy, dtheta = self._experiences.cells_from(experience, packet)
        facing = self.cell_states[experience, 2] * 2 * math.pi / self.shape[0]
        c, s = math.cos(facing), math.sin(facing)
        dx, dy = dx * self.cell_m, dy * self.cell_m
        turn = seen.facing_rad if seen.view >= 0 else None
        if turn is None:  # only the pose cells tell the heading
            turn = dtheta * 2 * math.pi / self.shape[0]
        return Pose2(c * dx + s * dy, -s * dx + c * dy, wrap_angle(turn))

    def _deviation(self, seen: Recognition) -> float:
        """How far (m) the robot may be from where the view was taken: the more the view differs, the farther."""
        return self.params.anchor_sigma * seen.difference if seen.view >= 0 else self.params.blind_sigma

"""Looks: which experience the robot sees, where that puts it, and whether it can be. ACRA 2006 section 3.1.

A look is a state of the pose cells and a scene. The papers take the experience with the most energy. What is ours
asks, too, whether the robot can be there (`extensions/gate.py`, `extensions/islands.py`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ratslam_core.experience_map.temporal_map import TemporalMap
from ratslam_core.extensions.evidence import Belief, Evidence
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.gate import Gate
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

    beats: int = 1  # for how many sights it counts, since it lasts so long
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
        self.gate = Gate(filter_params or PoseFilterParams())
        self.islands = Islands()
        self.carried = False  # it knows that it was carried away and has not found itself again
        self.corrected = 0  # how often looks that were held back proved the robot wrong

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
        """Where a robot that was carried believes itself to be on the map, apart from which it still maps; None for nowhere."""
        return self.evidence.belief if self.carried else None

    @property
    def temporal_map(self) -> TemporalMap:
        """Times and routes over the current links; the same object for as long as the map lives."""
        return self._temporal_map

    @property
    def diverged(self) -> bool:
        """Whether correction with the sweep "all at once" has thrown the map apart: `relaxation.sweep_all_at_once`."""
        return self.params.sweep == "all at once" and has_diverged(self.poses, self.moves)

    def _seen_experience(self, packet: Packet, seen: Recognition, by: Senses) -> tuple[int, Recognition]:
        """The experience that the robot sees, the most energetic of those that it can see, -1 for none; and as what.

        When what was held back has won, it is one beyond reach; where that lies on another submap, the two were merged.
        """
        reach = math.inf if self.carried and not self.params.islands else self.gate.reach_m(self.pose_filter.sigma_m)
        best = self._most_energetic(packet, seen.view, reach)
        if seen.view < 0 or not self.params.match_view:
            return best, seen
        if self.evidence.known:
            if (merged := self._merged(by)) is not None:
                return merged
            if len(self._of_view(seen.view, own=False)):
                return best, seen  # it is weighed as evidence for another submap, and not as a look at this one
        if math.isinf(reach):
            return best, seen
        if best >= 0 and not self.carried and self._turns(best, packet, seen):
            return (best if self._jumps(best, packet, seen, by) else -1), seen
        if (best >= 0 and not self._experiences.doubtful[best]) or self._sees_where_it_is(seen.view, reach):
            self.gate.doubt(by.beats)
            return best, seen
        far = self._most_energetic(packet, seen.view, reach, beyond=True)
        return (far if far >= 0 and self._jumps(far, packet, seen, by) else best), seen

    def _turns(self, experience: int, packet: Packet, seen: Recognition) -> bool:
        """[ours] Whether a look would turn the robot farther than its heading can be off, wherever it puts it.

        test_gate.py::test_a_look_that_turns_the_robot_is_held_back.
        """
        most = self.gate.params.gate_rad
        if most >= math.pi:
            return False
        claimed = self.pose(experience).compose(self._look(experience, packet, seen))
        return abs(wrap_angle(claimed.heading_rad - self.robot_here.heading_rad)) > most

    def _sees_where_it_is(self, view: int, reach_m: float) -> bool:
        """Whether an experience of this view that was not made in doubt lies within reach, wherever the packet is."""
        own = self._of_view(view, own=True)
        own = own[~self._experiences.doubtful[own]]
        return bool(len(own)) and self._away(own, self.robot_here).min() <= reach_m

    def _of_view(self, view: int, *, own: bool) -> NDArray[np.int64]:
        found = self._experiences.of_view(view)
        return found[(self.island_of[found] == self.islands.current) == own]

    def _away(self, which: NDArray[np.int64], pose: Pose2) -> NDArray[np.float64]:
        return np.hypot(self.poses[which, 0] - pose.x, self.poses[which, 1] - pose.y)

    def _most_energetic(self, packet: Packet, view: int, reach_m: float, *, beyond: bool = False) -> int:
        return self._experiences.most_energetic(
            packet, view, self.params, self.robot_here, reach_m, self.islands.current, beyond
        )

    def _merged(self, by: Senses) -> tuple[int, Recognition] | None:
        """The experience that the robot is at, and as what it sees it, if the evidence for that place is so strong that the
        submap is merged there; it then is. None if not.
        """
        belief = self.evidence.belief
        if belief is None or belief.log_odds < self.evidence.params.merge or by.views is None:
            return None
        look = self.pose(belief.experience).inverse().compose(belief.pose)
        if by.witness is not None and by.witness.confirms(self, belief.experience, look) is None:
            return None
        view = int(self.views[belief.experience])
        other = int(self.island_of[belief.experience])
        self.islands.join(other, self.island_of, self.poses, self.robot_here, belief.pose)
        self.evidence.end(len(self) if np.any(self.island_of != self.islands.current) else 0)
        self.carried = False
        return belief.experience, Recognition(view, False, view, by.views.difference_to(view), belief.facing_rad)

    def _jumps(self, experience: int, packet: Packet, seen: Recognition, by: Senses) -> bool:
        """Whether a look at the robot's own island is believed although it is beyond reach."""
        robot, claimed = self.robot_here, self._claimed(experience, packet, seen, by.witness)
        if claimed is None:
            return False
        if not self.carried and self._drifted_to(claimed, experience, by.beats):
            return self._proved(claimed, self.params.join_sights, seen, by)
        needed = self.params.join_sights if self.carried else self.gate.params.gate_sights
        if not self._proved(claimed, needed, seen, by):
            return False
        self.corrected += 1
        if not self.carried:
            off = math.hypot(claimed.x - robot.x, claimed.y - robot.y)
            soften(self.transitions, experience, self.gate.known, off, self.params.odometry_sigma)
        return True

    def _drifted_to(self, claimed: Pose2, experience: int, beats: int) -> bool:
        """Whether odometry may have led so far astray since it was last at this experience.

        Looks at what the robot has just made say nothing of that. test_gate.py::test_a_long_loop_closes_soon.
        """
        drift, off = self.gate.params.gate_drift, self._off(claimed)
        if drift == 0.0 or self.gate.sights < self.params.join_sights - beats:
            return False  # it would change nothing yet
        return off <= drift * open_way_m(self.transitions, experience, len(self))

    def _off(self, claimed: Pose2) -> float:
        return math.hypot(claimed.x - self.robot_here.x, claimed.y - self.robot_here.y)

    def _proved(self, claimed: Pose2, needed: int, seen: Recognition, by: Senses) -> bool:
        return self.gate.believes(
            self.robot_here, claimed, needed, len(self), view=seen.view, views=self.params.join_views, beats=by.beats,
            surprised=self._misses_what_it_expects(by.views),
        )  # fmt: skip

    def _misses_what_it_expects(self, views: LocalViewPart | None) -> bool:
        """[ours] Whether a known view is seen, but the place where the robot believes itself to be is known and looks different.

        test_gate.py::test_who_misses_what_it_expects_gives_way_sooner.
        """
        if views is None or not self.gate.sights or views.recognition.view < 0 or views.recognition.recruited:
            return False
        expected = self.views[self.ground.near]
        if np.any(expected == views.recognition.view):
            return False
        return views.unlike_all(expected, self.gate.params.gate_unlike)

    def _claimed(
        self, experience: int, packet: Packet, seen: Recognition, witness: Witness | None = None
    ) -> Pose2 | None:
        """Where a look puts the robot; None if the witness does not confirm it."""
        look = self._measured(experience, packet, seen, witness)
        return None if look is None else self.pose(experience).compose(look[0])

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

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
from ratslam_core.extensions.familiar_ground import FamiliarGround, NewGround
from ratslam_core.extensions.gate import Gate
from ratslam_core.extensions.islands import Islands, move
from ratslam_core.extensions.pose_filter import pose_estimate
from ratslam_core.extensions.torn import open_way_m, soften
from ratslam_core.params import ExperienceMapParams, MemoryParams, PoseFilterParams
from ratslam_core.parts import LocalViewPart, Witness
from ratslam_core.pose_graph.pose_graph import PoseGraph
from ratslam_core.pose_graph.relaxation import has_diverged
from ratslam_core.types import IDENTITY, Packet, Pose2, Recognition, nothing_seen, wrap_angle


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
    ) -> None:
        super().__init__(shape, cell_m, params)
        self.ground = ground or NewGround(MemoryParams())
        self.active = -1
        self.pose_filter = pose_estimate(filter_params or PoseFilterParams())
        self._temporal_map = TemporalMap(self)
        self.gate = Gate(filter_params or PoseFilterParams())
        self.islands = Islands()
        self._foreign_views: tuple[int, int, NDArray[np.int64]] = (0, 0, np.zeros(0, np.int64))
        self.lost = False  # it knows that it was carried away and has not found itself again
        self.corrected = 0  # how often looks that were held back proved the robot wrong

    @property
    def local_pose(self) -> Pose2:
        """Where the robot believes itself to be, in the frame of the active experience."""
        return self.pose_filter.local

    @property
    def robot(self) -> Pose2:
        """The robot in the map."""
        return self.pose(self.active).compose(self.local_pose)

    @property
    def temporal_map(self) -> TemporalMap:
        """Times and routes over the current links; the same object for as long as the map lives."""
        return self._temporal_map

    @property
    def diverged(self) -> bool:
        """Whether correction with the sweep "all at once" has thrown the map apart: `relaxation.sweep_all_at_once`."""
        return self.params.sweep == "all at once" and has_diverged(self.poses, self.moves)

    @property
    def foreign_views(self) -> NDArray[np.int64]:
        """The views of other islands. Where the robot has been on its own, it made views that hide them."""
        islands = self.islands
        if self._foreign_views[:2] != (islands.begun, islands.joined):
            apart = islands.begun > islands.joined
            views = self.views[self.island_of != islands.current] if apart else self.views[:0]
            self._foreign_views = islands.begun, islands.joined, np.unique(views[views >= 0]).astype(np.int64)
        return self._foreign_views[2]

    def _seen_experience(self, packet: Packet, seen: Recognition, by: Senses) -> tuple[int, Recognition]:
        """The experience that the robot sees, the most energetic of those that it can see, -1 for none; and as what.

        When what was held back has won, it is one beyond reach; where that lies on another island, the two were joined.
        """
        reach = math.inf if self.lost and not self.params.islands else self.gate.reach_m(self.pose_filter.sigma_m)
        best = self._most_energetic(packet, seen.view, reach)
        if seen.view < 0 or not self.params.match_view:
            return best, seen
        for look in (seen, self._elsewhere(by)) if self.islands.begun else ():
            foreign = self._foreign(packet, look) if look.view >= 0 else -1
            if foreign >= 0:
                return (foreign, look) if self._crosses(foreign, packet, look, by) else (best, seen)
        if math.isinf(reach):
            return best, seen
        if best >= 0 and not self.lost and self._turns(best, packet, seen):
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
        return abs(wrap_angle(claimed.heading_rad - self.robot.heading_rad)) > most

    def _foreign(self, packet: Packet, seen: Recognition) -> int:
        """The experience of another island that the robot sees, wherever its packet is; -1 for none.

        One where the robot would be had it not been carried comes first: perhaps it was not. Then the most energetic;
        then, of those of the view alone, the one nearest to where the robot would be by what it holds back.
        """
        others = self._of_view(seen.view, own=False)
        if len(others) == 0:
            return -1
        uncarried = self._away(others, self.robot)
        if uncarried.min() <= self.gate.params.snap_m:
            return int(others[np.argmin(uncarried)])
        best = self._most_energetic(packet, seen.view, math.inf, foreign=True)
        if best >= 0:
            return best
        expected = self.gate.hypothesis(self.robot)
        return int(others[0 if expected is None else np.argmin(self._away(others, expected))])

    def _sees_where_it_is(self, view: int, reach_m: float) -> bool:
        """Whether an experience of this view that was not made in doubt lies within reach, wherever the packet is."""
        own = self._of_view(view, own=True)
        own = own[~self._experiences.doubtful[own]]
        return bool(len(own)) and self._away(own, self.robot).min() <= reach_m

    def _of_view(self, view: int, *, own: bool) -> NDArray[np.int64]:
        found = self._experiences.of_view(view)
        return found[(self.island_of[found] == self.islands.current) == own]

    def _away(self, which: NDArray[np.int64], pose: Pose2) -> NDArray[np.float64]:
        return np.hypot(self.poses[which, 0] - pose.x, self.poses[which, 1] - pose.y)

    def _most_energetic(
        self, packet: Packet, view: int, reach_m: float, *, foreign: bool = False, beyond: bool = False
    ) -> int:
        return self._experiences.most_energetic(
            packet, view, self.params, self.robot, reach_m, self.islands.current, foreign, beyond
        )

    def _crosses(self, experience: int, packet: Packet, seen: Recognition, by: Senses) -> bool:
        """Whether a look at another island is believed; the robot's own is then joined to it."""
        robot, claimed = self.robot, self._claimed(experience, packet, seen, by.witness)
        if claimed is None or not self._proved(claimed, self._needed(claimed), seen, by):
            return False
        self.islands.join(int(self.island_of[experience]), self.island_of, self.poses, robot, claimed)
        return True

    def _jumps(self, experience: int, packet: Packet, seen: Recognition, by: Senses) -> bool:
        """Whether a look at the robot's own island is believed although it is beyond reach."""
        robot, claimed = self.robot, self._claimed(experience, packet, seen, by.witness)
        if claimed is None:
            return False
        if not self.lost and self._drifted_to(claimed, experience, by.beats):
            return self._proved(claimed, self.params.join_sights, seen, by)
        needed = self._needed(claimed) if self.lost else self.gate.params.gate_sights
        if not self._proved(claimed, needed, seen, by):
            return False
        self.corrected += 1
        if self.lost and experience < self.islands.landed:
            self.transitions.forget_across(self.islands.landed)
            move(np.arange(self.islands.landed, len(self)), self.poses, robot, claimed)
        elif not self.lost:
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
        return math.hypot(claimed.x - self.robot.x, claimed.y - self.robot.y)

    def _proved(self, claimed: Pose2, needed: int, seen: Recognition, by: Senses) -> bool:
        return self.gate.believes(
            self.robot, claimed, needed, len(self), view=seen.view, views=self.params.join_views, beats=by.beats,
            surprised=self._misses_what_it_expects(by.views),
        )  # fmt: skip

    def _elsewhere(self, by: Senses) -> Recognition:
        """Which of the views of other islands the robot sees."""
        foreign = self.foreign_views
        return nothing_seen() if by.views is None or len(foreign) == 0 else by.views.nearest_of(foreign)

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

    def _needed(self, claimed: Pose2) -> int:
        """How many sights must agree on `claimed` before a robot that is lost believes it.

        Perhaps it was not carried: then only where odometry leads to is a few sights worth.
        test_islands.py::test_who_was_perhaps_not_carried_asks_for_more.
        """
        plain = self.islands.sure or self._off(claimed) <= self.gate.params.snap_m
        return self.params.join_sights if plain else max(self.params.join_sights, self.params.doubtful_sights)

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

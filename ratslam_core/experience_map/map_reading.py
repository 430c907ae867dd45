"""Reading an experience map. How it is learnt is in experience_map.py."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.experience_map import relaxation
from ratslam_core.experience_map.experiences import Experiences
from ratslam_core.experience_map.temporal_map import TemporalMap
from ratslam_core.experience_map.transitions import Link, Transitions
from ratslam_core.extensions.pose_filter import pose_estimate
from ratslam_core.params import ExperienceMapParams, PoseFilterParams
from ratslam_core.types import Packet, Pose2, pose_of


class MapReading:
    """Experiences with their poses, links with their times, the robot in the map."""

    def __init__(
        self,
        shape: tuple[int, int, int],
        cell_m: float,
        params: ExperienceMapParams | None = None,
        filter_params: PoseFilterParams | None = None,
    ) -> None:
        self.params = params or ExperienceMapParams()
        self.shape, self.cell_m = shape, cell_m
        self._experiences = Experiences(shape)
        self.transitions = Transitions()
        self.active = -1
        self.pose_filter = pose_estimate(filter_params or PoseFilterParams())
        self._driven_m = self._driving_s = 0.0
        self._temporal_map = TemporalMap(self)

    def __len__(self) -> int:
        return self._experiences.count

    # ------------------------------------------------------------ experiences

    @property
    def poses(self) -> NDArray[np.float64]:
        """x, y (m), heading (rad) of every experience in the map, shape (n, 3). A view."""
        return self._experiences.pose[: self._experiences.count]

    @property
    def cell_states(self) -> NDArray[np.float64]:
        """x', y' (cells), theta' (layers) of every experience, shape (n, 3). A view."""
        return self._experiences.at[: self._experiences.count]

    @property
    def views(self) -> NDArray[np.int64]:
        """The scene of every experience, -1 for nothing to see, shape (n,). A view."""
        return self._experiences.view[: self._experiences.count]

    @property
    def island_of(self) -> NDArray[np.int32]:
        """The number of the island that each experience lies on, shape (n,): extensions/islands.py. A view."""
        return self._experiences.island[: self._experiences.count]

    def pose(self, experience: int) -> Pose2:
        """An experience's place in the map."""
        return pose_of(*self._experiences.pose[self._require(experience)].tolist())

    def cell_state(self, experience: int) -> tuple[float, float, float, int]:
        """x', y' (cells), theta' (layers) and the scene of one experience."""
        x, y, theta = self.cell_states[self._require(experience)]
        return float(x), float(y), float(theta), int(self.views[experience])

    def energy(self, experience: int, packet: Packet, view: int) -> float:
        """How well this state of pose cells and scene fits an experience; at most 2. See `Experiences.energy`."""
        return self._experiences.energy(self._require(experience), packet, view, self.params)

    def _require(self, experience: int) -> int:
        n = self._experiences.count
        if n == 0:
            raise ValueError(f"there is no experience yet, got {experience!r}")
        if not 0 <= experience < n:
            raise ValueError(f"experience must be from 0 to {len(self) - 1}, got {experience!r}")
        return experience

    # ------------------------------------------------------------ the robot

    @property
    def local_pose(self) -> Pose2:
        """Where the robot believes itself to be, in the frame of the active experience."""
        return self.pose_filter.local

    @property
    def robot(self) -> Pose2:
        """The robot in the map."""
        return self.pose(self.active).compose(self.local_pose)

    # ------------------------------------------------------------ links

    @property
    def link_count(self) -> int:
        return len(self.transitions.row_of)

    @property
    def links(self) -> NDArray[np.int64]:
        """From and to of every link, shape (m, 2)."""
        return self.transitions.ends[self._travelled]

    @property
    def moves(self) -> NDArray[np.float64]:
        """dx, dy (m) in the frame of the first experience and change of facing (rad) of every link, shape (m, 3)."""
        return self.transitions.move[self._travelled]

    @property
    def behaviours(self) -> NDArray[np.int8]:
        """The behaviour under which each link was learnt, shape (m,)."""
        return self.transitions.behaviour[self._travelled]

    @property
    def confidences(self) -> NDArray[np.float64]:
        """c_ij of every link, shape (m,). ACRA 2006 eq. 9."""
        return self.transitions.confidence[self._travelled]

    @property
    def link_times(self) -> NDArray[np.float64]:
        """Seconds that each transition takes, shape (m,).

        [ours] Never less than its length in the map takes at the robot's average pace. From the edge of one zone into
        the next it is only a step, and a route over many such links would promise to arrive in half the time.
        test_experience_map_transitions.py::test_no_link_is_quicker_than_the_robot.
        """
        return self.transitions.seconds(self.poses, self.pace)[self._travelled]

    @property
    def pace(self) -> float:
        """Seconds per metre, averaged over all driving so far; 0 before the robot has driven and when `pace_floor` is off."""
        return self._driving_s / self._driven_m if self._driven_m > 0 and self.params.pace_floor else 0.0

    @property
    def temporal_map(self) -> TemporalMap:
        """Times and routes over the current links; the same object for as long as the map lives."""
        return self._temporal_map

    def link(self, i: int, j: int) -> Link:
        """The link from experience i to j; ValueError when there is none."""
        row = self.transitions.row_of.get((i, j))
        if row is None:
            raise ValueError(f"there is no link from experience {i!r} to {j!r}")
        return self.transitions.link(row)

    @property
    def residual(self) -> tuple[float, float]:
        """By how much links and map disagree: distance (m) and angle (rad) between where a link says its end is and
        where the map has it. Root mean squares over the links, weighted by `believed`; 0 without links."""
        t, rows = self.transitions, self._travelled
        weight = t.believed[rows]
        if weight.sum() <= 0:
            return 0.0, 0.0
        apart = relaxation.disagreement(self.poses, t.ends[rows], t.move[rows]) ** 2 * weight[:, None]
        total = weight.sum()
        return float(np.sqrt(apart[:, :2].sum() / total)), float(np.sqrt(apart[:, 2].sum() / total))

    @property
    def diverged(self) -> bool:
        """Whether correction with the sweep "all at once" has thrown the map apart: `relaxation.sweep_all_at_once`."""
        return self.params.sweep == "all at once" and relaxation.has_diverged(self.poses, self.moves)

    @property
    def dropped_links(self) -> tuple[tuple[int, int], ...]:
        """From and to of every link that was deleted, in order. One that was driven again may be among `links`, too."""
        return tuple(self.transitions.dropped)

    @property
    def _travelled(self) -> NDArray[np.int64]:
        return np.flatnonzero(self.transitions.travelled[: self.transitions.count])

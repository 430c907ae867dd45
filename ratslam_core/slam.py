"""RatSLAM in one step: image and odometry in, place in the map out. ACRA 2004 section 4, ACRA 2006 section 3."""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import NDArray

from ratslam_core.experience_map import ExperienceMap
from ratslam_core.local_view import NOTHING, LocalView
from ratslam_core.params import RatSlamParams
from ratslam_core.pose_cells import PoseCells
from ratslam_core.transitions import require_behaviour
from ratslam_core.types import Estimate, Odometry
from ratslam_core.view_links import ViewLinks

FOUND_AGAIN = 8  # steps


class RatSlam:
    """The whole engine: local view, pose cells, experience map."""

    def __init__(self, params: RatSlamParams | None = None, rng: np.random.Generator | None = None) -> None:
        self.params = params or RatSlamParams()
        self.rng = rng or np.random.default_rng(0)
        self.local_view = LocalView(self.params.local_view)
        self.view_links = ViewLinks(self.params.local_view)
        self.pose_cells = PoseCells(self.params.pose_cells)
        self.experience_map = ExperienceMap(
            self.pose_cells.shape, self.params.pose_cells.cell_m, self.params.experience_map
        )
        self.relocalisations = 0
        self._time_s = 0.0
        self.lost = False
        self._known_before = self._agreed = 0
        self._learnt_s: list[float] = []  # when each view was recruited

    def step(self, image: NDArray[np.uint8], odometry: Odometry, behaviour: int = 0) -> Estimate:
        """One iteration at the end of a movement: `odometry` is what the wheels report of it, `image` what is seen then.

        image: (h, w) or (h, w, 3) uint8; behaviour: 0 to 15, the local movement that led here (D 3.2), ValueError for
        another one. The papers' four stages; path integration comes first because the image belongs to the end of the
        movement [ours].
        """
        require_behaviour(behaviour)
        self._time_s += odometry.dt
        odometry = self._calibrated(odometry)
        recognition = self.local_view.observe(image)
        if self.local_view.surprised:
            self._notice_kidnap()
        self.pose_cells.integrate(odometry.speed * odometry.dt, odometry.yaw_rate * odometry.dt)
        expected = self.pose_cells.winner
        if recognition.recruited:
            self._learnt_s.append(self._time_s)
        if recognition.view != NOTHING:
            self._associate(recognition.view, recognition.recruited)
        packet = self.pose_cells.attract()
        jump = self.pose_cells.cells_apart(expected.x, expected.y, packet.x, packet.y)
        relocalised = jump > self.params.pose_cells.snap_cells
        self.relocalisations += relocalised
        created = self.experience_map.step(packet, recognition, odometry, behaviour)
        self._find_again(created, recognition.view)
        self.experience_map.correct()
        return Estimate(
            self.experience_map.active, created, self.experience_map.robot, packet, recognition, relocalised
        )

    def digest(self) -> bytes:
        """SHA-256 of all that decides what the engine will do: equal for equal histories."""
        cells, activity = self.pose_cells.active
        map_, t = self.experience_map, self.experience_map.transitions
        rows = slice(t.count)
        state = hashlib.sha256()
        links = (t.ends, t.move, t.weight, t.time_s, t.travelled, t.behaviour, t.trials, t.confidence)
        for array in (cells, activity, map_.poses, *(column[rows] for column in links)):
            state.update(np.ascontiguousarray(array).tobytes())
        state.update(self.local_view.templates.tobytes())
        for view in range(len(self.local_view)):
            for array in self.view_links.of(view):
                state.update(array.tobytes())
        numbers = (self.pose_cells.carry, map_.active, map_.local_pose, map_.yaw_bias, self.relocalisations)
        state.update(repr((*numbers, self.lost, self._agreed, self._time_s, self._learnt_s, self.params)).encode())
        return state.digest()

    def set_params(self, params: RatSlamParams) -> None:
        """Take new live parameters while running; ValueError when the size of the pose cells would change."""
        self.pose_cells.set_params(params.pose_cells)
        self.local_view.params = self.view_links.params = params.local_view
        self.experience_map.params = params.experience_map
        self.params = params

    def _notice_kidnap(self) -> None:
        """[ours] The image jumped though the wheels did not: the robot knows that it is lost.

        test_slam.py::test_a_kidnap_is_noticed_and_survived.
        """
        self.lost, self._known_before, self._agreed = True, len(self.experience_map), 0
        self.experience_map.lose_track()

    def _find_again(self, created: bool, view: int) -> None:
        """Lost no more once experiences from before the kidnap have been recognised FOUND_AGAIN times in a row."""
        if not self.lost or view == NOTHING:
            return
        known = not created and self.experience_map.active < self._known_before
        self._agreed = self._agreed + 1 if known else 0
        self.lost = self._agreed < FOUND_AGAIN

    def _calibrated(self, odometry: Odometry) -> Odometry:
        """[ours] Odometry without the yaw bias that the map has learnt; wheels that stand have none."""
        bias = self.experience_map.yaw_bias
        if bias == 0.0 or (odometry.speed == 0 and odometry.yaw_rate == 0):
            return odometry
        return Odometry(odometry.speed, odometry.yaw_rate - bias, odometry.dt)

    def _associate(self, view: int, recruited: bool) -> None:
        """Visual calibration by what the view is linked to, then association with where the packet is."""
        cells, activity = self.pose_cells.active
        if recruited:
            self.view_links.learn(view, cells, activity, self.pose_cells.slot)
        if self._time_s - self._learnt_s[view] < self.params.local_view.rest:
            return
        linked, injection = self.view_links.recall(view, self.lost)
        linked = linked.copy()
        self.view_links.learn(view, cells, activity, self.pose_cells.slot)
        self.pose_cells.inject(linked, injection)

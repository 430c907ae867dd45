"""RatSLAM in one step: image and odometry in, place in the map out. ACRA 2004 section 4, ACRA 2006 section 3."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.beats import Tick
from ratslam_core.brain import Brain
from ratslam_core.local_view.recogniser import NOTHING
from ratslam_core.localisation import again
from ratslam_core.parts import GeometricVerification
from ratslam_core.pose_graph.transitions import require_behaviour
from ratslam_core.types import Bytes, Estimate, Floats, Odometry, Recognition

# The stages of `RatSlam.step`, in the papers' order.
STAGES = ("view match", "injection", "path integration", "attractor", "experience", "correction", "memories")


def _nobody(_stage: str) -> None:
    """The default for `watch`: does nothing."""


@kind("ratslam/5")
class RatSlam(Brain):
    """A brain that takes the papers' steps."""

    def step(
        self,
        image: Bytes | None,
        odometry: Odometry,
        *,
        scene: int | None = None,
        behaviour: int = 0,
        ranges_m: NDArray[np.floating] | None = None,
        watch: Callable[[str], None] | None = None,
        verification: GeometricVerification | None = None,
    ) -> Estimate:
        """One iteration at the end of a movement: `odometry` is what the wheels report of it, `image` what is seen then.

        image: (h, w) or (h, w, 3) uint8; scene: its number, for the front end "scene numbers", which ignores the image;
        behaviour: 0 to 15, the local movement that led here (D 3.2); ranges_m: the sonars' ranges in m, shape
        (n_sonars,), for the front end "image and sonars", the occupancy pictures and to notice a kidnap; watch: called
        after each of STAGES with its name; it may look but change nothing; verification: drops observations that it
        does not confirm. ValueError when one of them is not valid; nothing has changed then.

        [ours] Vision, attractor and map act in beats of 0.1 s (`beats.py`). Between two beats nothing is looked at, and
        only the robot's pose in the map moves on.
        """
        require_behaviour(behaviour)
        scan, watch, map_ = self.memories.require_sonars(ranges_m), watch or _nobody, self.experience_map
        if self.beats.due(odometry.dt) == 0:
            return self._coast(self.beats.take(odometry), watch)
        seen = self.local_view.observe(image, scene, scan, self.beats.turned_by(odometry), map_.ground)
        tick = self.beats.take(odometry).without(map_.yaw_bias)
        watch("view match")
        self._notice_kidnap(scan, tick)
        packet, jumped = self.localisation.step(seen, self.local_view.strength(seen), tick, self.carried, watch)
        self._hear(scan, tick)
        created = map_.step(
            packet, seen, tick.latest, behaviour, beats=tick.beats, views=self.local_view,
            verification=verification or self.scans,
        )  # fmt: skip
        if created and self.scans is not None:
            self.scans.made(map_.here)
            self.echo_closures.made(map_, self.scans)
        self._settle(seen, created, tick)
        map_.ground.note(map_, seen, created, tick.moved, self.carried, tick.beats)
        watch("experience")
        map_.correct(tick.beats)
        watch("correction")
        self.memories.learn(tick, scan, self.pose_cells, map_, packet, jumped or self.carried)
        watch("memories")
        self.relocalisations += jumped
        return Estimate(map_.active, created, map_.robot, packet, seen, jumped)

    def _notice_kidnap(self, scan: Floats | None, tick: Tick) -> None:
        if not self.kidnap_detector.observe(self.local_view.image_change, scan, tick.beats):
            return
        driven = not tick.moved.still  # driving is all that a false alarm comes of
        if self.kidnap_detector.sure or not driven or not self.experience_map.suspect_kidnap():
            self.declare_kidnapped()
        elif self.scans is not None:
            self.scans.forget()

    def _hear(self, scan: Floats | None, tick: Tick) -> None:
        if self.scans is not None:
            self.scans.sense(scan, tick.moved, tick.beats)

    def _settle(self, seen: Recognition, created: bool, tick: Tick) -> None:
        map_ = self.experience_map
        known = NOTHING if created or seen.view == NOTHING else map_.here
        if map_.carried and not self.carried:
            self.kidnap_detector.declare(map_.evidence.known)
        if self.carried and not map_.carried:
            self.kidnap_detector.find()
        elif self.kidnap_detector.settle(map_.agrees, known, tick.beats):
            map_.declare_found()

    def _coast(self, tick: Tick, watch: Callable[[str], None]) -> Estimate:
        """A tick between two beats: the movement is kept for the next one, and the robot moves on in the map."""
        map_ = self.experience_map
        map_.move(tick.without(map_.yaw_bias).latest)
        for stage in STAGES:
            watch(stage)
        return Estimate(
            map_.active, False, map_.robot, self.pose_cells.winner, again(self.local_view.recognition), False
        )

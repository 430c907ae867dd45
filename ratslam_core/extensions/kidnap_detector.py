"""[ours] Notices that the robot was carried away, and when it knows again where it is.

Image and sonars jump although the wheels did not. A robot that did not notice would learn the way it was carried as a
link, which bends the map. The image alone misses many kidnaps, since walls look alike, and sometimes raises a false
alarm when something is near. test_kidnap_detector.py::{test_a_kidnap_is_noticed_and_survived,
test_sonars_help_to_notice_a_kidnap}.
`NeverKidnapped` is the plain twin: the papers' robots relocalised by their pose cells alone.
"""

from __future__ import annotations

import math

from numba import njit

from disk import kind
from ratslam_core.beats import weight
from ratslam_core.params import KidnapParams
from ratslam_core.types import Floats

USUAL_TIMES, USUAL_RATE = 2.0, 0.02  # a jump is more than twice the usual change, a mean over some fifty beats
MOST_USUAL = 2.0  # a larger change counts as this, since it may be infinite
TIME_POWER = 0.3  # of the beats between two images; so many times as much can driving explain
SETTLED = 1200  # beats without a contradiction, two minutes, after which the robot is no longer lost, either
FOUND_AGAIN = 8  # observations of known places, one a beat, that must agree before the robot is no longer lost


@kind("kidnap detector/4")
class KidnapDetector:
    """`kidnapped` is true from the jump until known places agree."""

    def __init__(self, params: KidnapParams) -> None:
        self.params = params
        self.kidnapped = False
        self._usual = 1.0  # mean change of the image; to begin with, nothing is known of it
        self.sure = True  # whether the image alone told of the last jump, and driving cannot explain it
        self._scans = ScanChange()
        self._known_before = 0  # how many experiences there were when it happened
        self._agreed = self._settled = 0

    def observe(self, image_change: float, ranges_m: Floats | None, beats: int = 1) -> bool:
        """Whether image and sonars say that the robot was carried away since the step before.

        image_change: above 1 driving cannot explain it (`LocalView.image_change`); ranges_m: (n_sonars,), m. Sonars
        alone do not tell: when a robot turns between two walls, all of them jump. Nor does an image, where images change
        as much all the time. test_kidnap_detector.py::test_where_images_always_jump_a_jump_tells_nothing.

        beats: since the step before; in more time driving explains more (TIME_POWER).
        test_kidnap_detector.py::test_in_more_time_driving_explains_more.
        """
        explained = float(beats**TIME_POWER)
        image_change /= explained
        heard = self.params.range_surprise * self._scans.observe(ranges_m) / explained
        self.sure = image_change > 1
        jumped = image_change + heard > max(1.0, USUAL_TIMES * self._usual)
        self._usual += weight(USUAL_RATE, beats) * (min(image_change, MOST_USUAL) - self._usual)
        return jumped

    def declare(self, experiences: int) -> None:
        """The robot was carried; `experiences` is how many there are at this moment."""
        self.kidnapped, self._known_before = True, experiences
        self._agreed = self._settled = 0

    def find(self) -> None:
        """The robot has found itself."""
        self.kidnapped = False

    def settle(self, agrees: bool, known: int, beats: int = 1) -> bool:
        """So many more beats; whether the robot has found itself in them.

        It is no longer lost once FOUND_AGAIN observations of experiences from before the kidnap, taking into account the
        odometry between them, agree on where it is. New experiences in between count neither way: perhaps only a wall
        was drawn. It is no longer lost either after SETTLED beats without a contradiction: it is elsewhere and knows its
        way there.

        agrees: whether the observation agrees with where the robot believed itself to be; known: the experience that was
        recognised, -1 for none. test_kidnap_detector.py::{test_a_changed_place_does_not_keep_the_robot_lost,
        test_nobody_is_lost_for_ever}.
        """
        lost = self.kidnapped
        for _ in range(beats):
            if self.kidnapped:
                self._settle(agrees, known)
        return lost and not self.kidnapped

    def _settle(self, agrees: bool, known: int) -> None:
        if not agrees:
            self._agreed = self._settled = 0
        self._agreed += 0 <= known < self._known_before
        self._settled += 1
        self.kidnapped = self._agreed < FOUND_AGAIN and self._settled < SETTLED


@kind("never kidnapped/2")
class NeverKidnapped:
    """As in the papers: kidnaps are not noticed, and the robot is never lost."""

    kidnapped = False
    sure = True

    def __init__(self, params: KidnapParams) -> None:
        self.params = params

    def observe(self, _image_change: float, _ranges_m: Floats | None, _beats: int = 1) -> bool:
        return False

    def declare(self, _experiences: int) -> None: ...
    def find(self) -> None: ...
    def settle(self, _agrees: bool, _known: int, _beats: int = 1) -> bool:
        return False


NEAR_M, REACH_M = 0.2, 4.0  # shorter and longer ranges count as these, since distant echoes come and go
MOST = 0.35  # a larger change of one sonar, as the logarithm of the ratio of its ranges, counts as this


@kind("scan change/3")
class ScanChange:
    """[ours] How much the sonars changed at once. Driving past a corner changes one or two of them, being carried away most.

    Ranges are compared by their ratio, since a few centimetres are much beside a wall and nothing in a hall, and each
    sonar counts up to a limit, so that one that looks past a corner does not speak for all. test_scan_change.py.
    """

    def __init__(self) -> None:
        self._last: Floats | None = None

    def observe(self, ranges_m: Floats | None) -> float:
        """By how much the sonars differ from the scan before: the mean of |ln(now / before)|, each at most MOST.

        0 when there is nothing to compare with. ranges_m: (n,) metres, none negative; None forgets the scan before.
        """
        last, self._last = self._last, None if ranges_m is None else ranges_m.copy()
        if last is None or ranges_m is None:
            return 0.0
        return _change(last, ranges_m)


@njit(cache=True, nogil=True)
def _change(before: Floats, now: Floats) -> float:
    total = 0.0
    for k in range(len(now)):
        ratio = min(max(now[k], NEAR_M), REACH_M) / min(max(before[k], NEAR_M), REACH_M)
        total += min(abs(math.log(ratio)), MOST)
    return total / len(now)

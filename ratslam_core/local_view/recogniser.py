"""Local view cells: each stands for one scene, recognised by the sum of absolute differences of its features.

ACRA 2006 section 7 (view matcher), ACRA 2004 section 3.3 (one cell per scene), IROS 2005 (recruitment). The front end
decides what the features are.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from disk import kind
from ratslam_core.local_view.echo_matcher import EchoMatcher
from ratslam_core.local_view.front_ends import FRONT_ENDS, FrontEnd
from ratslam_core.local_view.matcher import Features, Matcher, heard_apart, least_difference, sub_column, turned_apart
from ratslam_core.params import LocalViewParams
from ratslam_core.parts import Room
from ratslam_core.types import Bytes, Floats, Ints, Recognition, grown, nothing_seen

NOTHING = -1
TURN_SLACK = 0.3  # share of the turn by which the wheels may be wrong about it in a beat
MOST_SHIFT = 6  # columns; beyond, too little is left to compare


@kind("local view/4")
class LocalView:
    """The known scenes. `observe` recognises an image or recruits a new cell for it."""

    SHARED = ("features", "_last")  # one array, which is never written to
    CACHES = ("_search",)  # made from the front end and the views

    def __init__(
        self,
        params: LocalViewParams | None = None,
        rng: np.random.Generator | None = None,
        front_end: FrontEnd | None = None,
    ) -> None:
        """front_end: used instead of the one that the parameters choose."""
        self.params = params or LocalViewParams()
        self.rng = rng or np.random.default_rng(0)  # draws false positives and nothing else
        self.front_end: FrontEnd = front_end or FRONT_ENDS[self.params.front_end]()
        end = self.front_end
        size = end.columns * end.rows + end.echoes
        self.features = np.zeros(size, np.uint8)  # of what is seen now
        self.recognition = nothing_seen()
        self.image_change = 0.0  # since the image before, as a share of what driving can explain; above 1 it cannot
        self.false_positives = 0  # so far
        self._templates = np.zeros((1024, size), np.uint8)
        self._count = 0
        self._search: Matcher | None = None
        self._last: Features | None = None

    def __len__(self) -> int:
        return self._count

    @property
    def _matcher(self) -> Matcher:
        self._search = self._search or matcher_of(self.front_end)
        return self._search

    @property
    def templates(self) -> Bytes:
        """The features of all known scenes, shape (n, columns * rows + echoes). A view."""
        return self._templates[: self._count]

    @property
    def memory_bytes(self) -> int:
        """Memory of the known scenes, including room for more."""
        return self._templates.nbytes

    def stored(self, view: int) -> Features:
        """The features of one view, shape (columns * rows + echoes,); `front_end.picture` draws them."""
        if not 0 <= view < self._count:
            raise ValueError(f"view must be from 0 to {self._count - 1}, got {view!r}")
        return self._templates[view]

    def difference_to(self, view: int) -> float:
        """How far one known view is from what was seen last, as `Recognition.difference` counts it."""
        most = self.params.shift if self.front_end.shifts else 0
        stored = self.stored(view)
        end, new = self.front_end, self.features
        heard = end.echo_weight * heard_apart(new, stored, end.columns * end.rows) if end.echoes else 0.0
        return self._levels(least_difference(new, stored, most, end.columns, end.rows) + heard, new)

    def apart_at(self, views: Ints, shifts: Ints, slack: int) -> tuple[Floats, Ints]:
        """[ours] How unlike (bytes) each of these views (k,) is to what was seen last, shifted by so many columns, give or take
        `slack`; and by which of these it is least unlike, (k,). A front end that knows no shifts compares views as they are.
        test_recogniser.py::test_a_view_is_compared_under_the_turn_that_is_asked_for."""
        end = self.front_end
        most, slack = (min(MOST_SHIFT, end.columns - 1), slack) if end.shifts else (0, 0)
        shifts = np.minimum(np.maximum(shifts, -most), most)
        return self._matcher.apart_at(self.templates, self.features, views, shifts, slack, most, end.echo_weight)

    @property
    def column_rad(self) -> float:
        """The heading that a shift by a column stands for, 0 where none is told."""
        return self.params.field_of_view / self.front_end.columns if self.front_end.shifts else 0.0

    @property
    def threshold(self) -> float:
        """The difference, in levels, up to which a view is recognised."""
        return max(self.front_end.threshold * self.params.match_threshold, self.front_end.vague)

    def strength(self, seen: Recognition) -> float:
        """How sure a recognition is: 1 for a new or an equal view, 0 for one that is only just recognised."""
        vague, limit = self.front_end.vague, self.threshold
        if seen.recruited or limit <= vague:
            return 1.0
        return min(1.0, 1 - (seen.difference - vague) / (limit - vague))

    def observe(
        self,
        image: Bytes | None,
        scene: int | None = None,
        ranges_m: NDArray[np.floating] | None = None,
        turned_rad: float = 0.0,
        room: Room | None = None,
    ) -> Recognition:
        """The active cell for what is seen now; a new one if no known one is like it.

        image: (h, w) grey or (h, w, 3) RGB, uint8. scene: for the front end "scene numbers", which looks at nothing
        else. ranges_m: of the sonars, for "image and sonars", shape (n_sonars,); without them the image alone counts.
        turned_rad: what the wheels say of the turn since the image before, left positive. room: whether a new cell may be
        recruited, and whose room it gets.

        An image that is bland to the front end activates no cell and recruits none; with vision off, no image does.
        """
        features = self.front_end.look(image, scene, ranges_m)
        self.image_change = self._jump(features, turned_rad)
        self.features = self._last = features
        most = self.params.shift if self.front_end.shifts else 0
        best, apart, shift = self._matcher.nearest(self.templates, features, most)
        apart = self._levels(apart, features)
        if not self.params.enabled or self.front_end.bland(features):
            self.recognition = Recognition(NOTHING, False, best, apart)
        elif apart <= self.threshold:
            self.recognition = self._recognised(best, apart, shift)
        elif room is not None and room.familiar:
            self.recognition = Recognition(NOTHING, False, best, apart, familiar=True)
        else:
            new = self._recruit(features, -1 if room is None else room.faded)
            self.recognition = Recognition(new, True, best, apart)
        return self.recognition

    def _recognised(self, best: int, apart: float, shift: int) -> Recognition:
        """The view that was found or, with probability `false_positives`, another: N_vis of ACRA 2006 section 5.1.

        New scenes are still recruited, and a view is never replaced by itself.
        """
        if self.params.false_positives > 0 and self._count > 1 and self.rng.random() < self.params.false_positives:
            other = int(self.rng.integers(self._count - 1))
            self.false_positives += 1
            return Recognition(other + (other >= best), False, best, apart, None, True)
        return Recognition(best, False, best, apart, self._facing(best, shift))

    def _facing(self, view: int, shift: int) -> float | None:
        """[ours] The heading (rad) relative to that at which the view was taken, from the shift; None if columns tell none."""
        if not self.front_end.shifts or not self.params.facing:
            return None
        return self._sub_column(view, shift) * self.params.field_of_view / self.front_end.columns

    def _jump(self, features: Features, turned_rad: float) -> float:
        """By how much the last image, turned as the wheels say, differs from this one, over the limit.

        Wheels are wrong by a share of the turn, and when they slip, nothing turns: such turns explain it as well.
        test_recogniser.py::test_a_turn_that_the_wheels_tell_of_is_no_jump.
        """
        limit = self.front_end.surprise * self.params.surprise
        if self._last is None or not self.params.enabled or math.isinf(self.front_end.surprise):
            return 0.0
        end = self.front_end
        told, slack = turned_rad * end.columns / self.params.field_of_view, TURN_SLACK
        if end.shifts and abs(told) > end.columns - 1:
            return 0.0  # nothing of what it saw can still be seen
        shifts = {0.0, told * (1 - slack), told, told * (1 + slack)} if end.shifts else {0.0}
        least = end.scale * min(turned_apart(features, self._last, shift, end.columns, end.rows) for shift in shifts)
        if limit == 0:
            return math.inf if least > 0 else 0.0
        return least / limit

    def _sub_column(self, view: int, shift: int) -> float:
        """The shift to a fraction of a column, 0 where no shifts are tried."""
        if self.params.shift == 0:
            return 0.0
        end = self.front_end
        return sub_column(self.features, self._templates[view], shift, end.columns, end.rows)

    def _levels(self, apart: float, new: Features) -> float:
        """A mean difference in bytes from the new view in levels."""
        end = self.front_end
        return max(apart * end.scale + end.doubt(new), end.vague)

    def _recruit(self, features: Features, faded: int) -> int:
        if faded >= 0:
            self._templates[faded] = features
            self._matcher.replaced(faded, features)
            return faded
        if self._count == len(self._templates):
            half_as_many_again = self._count * 3 // 2  # a view stays below 150 bytes
            self._templates = grown(self._templates, half_as_many_again)
        self._templates[self._count] = features
        self._count += 1
        return self._count - 1


def matcher_of(end: FrontEnd) -> Matcher:
    """The matcher for a front end's features."""
    if end.echoes:
        return EchoMatcher(end.columns, end.rows, end.echoes, end.echo_weight)
    return Matcher(end.columns, end.rows)

"""What is true of the local view and of its links to the pose cells between two steps."""

# Laws look at all of a state, and take nothing for granted.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ratslam_core.laws.measures import apart, array, number, true, whole, within
from ratslam_core.local_view.echo_matcher import EchoMatcher
from ratslam_core.local_view.matcher import Matcher
from ratslam_core.local_view.recogniser import LocalView, matcher_of
from ratslam_core.local_view.view_links import ViewLinks
from ratslam_core.types import Recognition


def local_view(view: LocalView) -> None:
    """ValueError names the first law that does not hold."""
    size = whole("columns", view.front_end.columns, 1, 4096) * whole("rows", view.front_end.rows, 1, 4096)
    size += whole("echoes", view.front_end.echoes, 0, 4096)
    known = array("templates", view._templates, np.uint8, (None, size))
    true(len(known) > 1, "templates must have room to grow by half")
    count = whole("the number of views", view._count, 0, len(known))
    array("features", view.features, np.uint8, (size,))
    if view._last is not None:
        array("the last features", view._last, np.uint8, (size,))
    number("surprise", view.image_change, 0.0)
    whole("false positives", view.false_positives)
    _recognition(view.recognition, count)
    for matcher in (view._matcher,):
        _matcher(matcher, matcher_of(view.front_end))


def _recognition(seen: Recognition, count: int) -> None:
    whole("the recognised view", seen.view, -1, count - 1)
    whole("the best view", seen.best_view, -1, count - 1)
    number("its difference", seen.difference, 0.0)
    if seen.facing_rad is not None:
        number("its facing", seen.facing_rad, -20.0, 20.0)


def _matcher(matcher: Matcher, fresh: Matcher) -> None:
    same = (matcher.columns, matcher.rows) == (fresh.columns, fresh.rows)
    true(same, "the matcher must be of the front end's columns and rows")
    if isinstance(matcher, EchoMatcher) and isinstance(fresh, EchoMatcher):
        same = (matcher.echoes, matcher.echo_weight) == (fresh.echoes, fresh.echo_weight)
        true(same, "the matcher must weigh echoes as the front end does")
        whole("where the search begins", matcher._guess, 0)
    true(type(matcher) is type(fresh), "the matcher must be of the front end's kind")
    array("masks", matcher._masks, np.uint8, fresh._masks.shape)
    true(np.array_equal(matcher._masks, fresh._masks), "masks must be those of the shifts")
    shifted = array("the shifted view", matcher._shifted, np.uint8, fresh._shifted.shape)
    true(not (shifted & ~fresh._masks).any(), "the shifted view must be empty where nothing overlaps")
    array("least", matcher._least, np.int32, fresh._least.shape)
    array("at", matcher._at, np.int64, fresh._at.shape)


def view_links(links: ViewLinks, views: int, cells: int) -> None:
    """views: how many are known; cells: how many pose cells there are."""
    size = len(array("linked cells", links._cells, np.int32, (None,)))
    strength = array("strengths", links._strength, np.float32, (size,))
    start, used, room = array("blocks", links._blocks, np.int64, (None, 3)).T
    whole("forgotten links", links.forgotten)
    array("seen", links._seen, np.bool_, (None,))
    apart("blocks of links", start, room, whole("their end", links._end, 0, size), size)
    true(((used >= 0) & (used <= room)).all(), "a block of links must have room for those in use")
    true(not used[views:].any(), f"only the {views} known views may have links")
    at = places(start, used)
    within("a linked cell", links._cells[at], 0, cells - 1)
    within("a strength", strength[at], 0.0, float(np.finfo(np.float32).max))


def places(start: NDArray[np.int64], used: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where in an arena the blocks' entries in use lie, block after block."""
    begins = np.cumsum(used) - used
    return np.arange(int(used.sum())) + np.repeat(start - begins, used)


def learnt(times_s: list[float], views: int, now_s: float) -> None:
    """When each view was recruited."""
    true(len(times_s) == views, f"each of {views} views must have a time, got {len(times_s)}")
    for time_s in times_s:
        number("when a view was recruited", time_s, 0.0, now_s)

"""The tab Senses: views, their difference, and the pose cells from above."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.panel_page import Page
from web.panel.panel import Panel
from web.panel.senses import RECENT, RecentViews, from_above
from web.switches import Switches


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


def senses(page: Page, **changes: Any) -> dict[str, Any]:
    snapshot = fake_snapshot(430)
    return page.told(replace(snapshot, senses=replace(snapshot.senses, **changes)))["views"][0]


def test_the_verdict_on_a_view(page: Page) -> None:
    assert senses(page, active_view=4, recruited=True)["verdict"] == {"tone": "new", "words": "new: recruited"}
    assert senses(page, active_view=4, recruited=False)["verdict"] == {"tone": "known", "words": "known: recalled"}
    assert senses(page, active_view=-1)["verdict"] == {"tone": "none", "words": "nothing to see"}
    false = senses(page, false_positive=True, false_positives=3, best_view=9)
    assert false["verdict"] == {"tone": "false", "words": "false positive 3: rightly #9"}


def test_the_difference_is_told_against_its_threshold(page: Page) -> None:
    told = senses(page, difference=6.0, threshold=8.0)["difference"]
    assert told == {"words": "difference to the best view 6.0 (threshold 8.0)", "share": 0.375, "known": True}
    assert senses(page, difference=99.0, threshold=8.0)["difference"]["share"] == 1.0
    assert senses(page, difference=math.inf)["difference"]["words"] == "difference: nothing to compare with"


@pytest.mark.parametrize("front_end", ["template", "colour histogram"])
def test_the_senses_show_what_the_front_end_sees(page: Page, front_end: str) -> None:
    snapshot = fake_snapshot(430)
    seen = np.arange(24, dtype=np.uint8).reshape(4, 6) if front_end == "template" else np.zeros((2, 5, 3), np.uint8)
    told, arrays = page.told(
        replace(snapshot, senses=replace(snapshot.senses, front_end=front_end, seen=seen, seen_words="as it is"))
    )["views"]
    assert told["seen"] == {"title": f"{front_end} now", "words": "the present view: as it is"}
    np.testing.assert_array_equal(arrays["seen"], seen)


def test_cells_from_above_and_by_heading_hold_all_activity(page: Page) -> None:
    layer = fake_snapshot(430).pose_cells
    _, arrays = page.told(fake_snapshot(430))["cells"]
    assert arrays["by_heading"].sum() == pytest.approx(layer.activity.sum(), rel=1e-5)
    n_x = layer.shape[2]
    columns = np.zeros(layer.shape[1:])
    np.add.at(columns, (layer.cells[:, 1], layer.cells[:, 2]), layer.activity)
    drawn = np.zeros(columns.size)
    np.add.at(drawn, arrays["places"], arrays["strength"])
    assert (drawn > 0).sum() <= (columns > 0).sum()
    strongest = int(drawn.argmax())
    assert (strongest // n_x, strongest % n_x) == np.unravel_index(columns.argmax(), columns.shape)
    assert set(arrays["packets"]) <= set(range(len(layer.packets)))


def test_without_activity_there_is_nothing_from_above() -> None:
    layer = fake_snapshot(430).pose_cells
    bare = replace(layer, cells=layer.cells[:0], activity=layer.activity[:0], packets=())
    assert [len(column) for column in from_above(bare)] == [0, 0, 0]


def test_the_strip_of_cells_is_told_together_with_the_view_beside_it(page: Page) -> None:
    """Apart they would show two views at once while the robot is fast."""
    page.reader.tabs = ("Senses",)
    for tick in (430, 431):
        snapshot = replace(fake_snapshot(tick), run=1)
        seen = replace(snapshot, senses=replace(snapshot.senses, active_view=tick))
        told, _ = page.told(seen, after_s=0.2)["views"]  # which is too early for another picture of the pose cells
        assert (told["active"], told["recent"][-1], told["known"]) == (tick, tick, seen.views)


def test_the_views_that_were_active_lately_are_kept_for_a_run() -> None:
    recent, snapshot = RecentViews(), fake_snapshot(430)

    def see(view: int, run: int = 1) -> tuple[int, ...]:
        recent.remember(replace(snapshot, run=run, senses=replace(snapshot.senses, active_view=view)))
        return recent.numbers

    assert see(3) == (3,)
    kept = see(3)
    assert see(3) is kept  # the same object: nothing to draw
    assert see(-1) is kept
    assert see(5) == (3, 5)
    for view in range(200):
        see(view)
    assert recent.numbers == tuple(range(200 - RECENT, 200))
    assert see(8, run=2) == (8,)

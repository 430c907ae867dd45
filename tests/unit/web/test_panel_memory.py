"""The tab Memory: packets, goal, snaps and the checks of the attractor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.panel_page import Page, words_of
from web.messages import Belief, Event, Goal, Hypothesis, Snap, SnapCause, Snapshot
from web.panel.panel import Panel
from web.switches import Switches


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


def memory(page: Page, snapshot: Snapshot) -> str:
    return words_of(page.told(snapshot)["memory"][0]["tables"])


def test_the_memory_says_why_there_is_nothing(page: Page) -> None:
    snapshot = fake_snapshot(430)
    bare = replace(snapshot, events=(), goal=None, relocalisations=0, revisit_consistency=None)
    bare = replace(bare, pose_cells=replace(bare.pose_cells, packets=()))
    words = memory(page, bare)
    assert "no activity yet" in words
    assert "none: click on the map and the robot goes there" in words
    assert "none yet: nothing seen before has come into view again" in words
    assert "nothing had to jump" in memory(page, replace(bare, revisit_consistency=0.5))
    assert "none of late: 7 so far" in memory(page, replace(bare, relocalisations=7))


def test_the_memory_tells_packets_goal_and_snaps_with_their_units(page: Page) -> None:
    snapshot = replace(
        fake_snapshot(430), goal=Goal(7, 1.0, 2.0, "tracking", 12.4, 3.21, np.zeros((0, 2)), np.zeros(0))
    )
    packet = snapshot.pose_cells.packets[0]
    snapshot = replace(snapshot, events=(Event(1, 65.0, "snap", "snapped 5.6 m"), Event(2, 70.0, "goal", "goal set")))
    words = memory(page, snapshot)
    assert f"x′ {packet.x * snapshot.pose_cells.cell_m:.1f} m" in words
    assert "'12 s'" in words
    assert "'3.2 m'" in words
    assert "('1:05', 'snapped 5.6 m')".replace("(", "[").replace(")", "]") in words
    assert "goal set" not in words


def test_the_memory_tells_which_links_made_the_last_snap(page: Page) -> None:
    snapshot = fake_snapshot(430)
    snap = Snap(65.0, *[snapshot.pose_cells.packets[0]] * 2, (SnapCause(312, 7, 1.2, 0.41, 90, 0.02, 61.3),))
    words = memory(page, replace(snapshot, pose_cells=replace(snapshot.pose_cells, last_snap=snap)))
    assert "Views that made the snap of 1:05" in words
    assert "view 312" in words
    assert "7 looks, 41 % of the injected activity; 90 links there, up to 0.02; learnt 61 s before" in words
    bare = replace(snap, causes=())
    words = memory(page, replace(snapshot, pose_cells=replace(snapshot.pose_cells, last_snap=bare)))
    assert "none: no view put activity there" in words


def test_the_memory_tells_of_how_many_experiences_the_goal_is_one(page: Page) -> None:
    goal = Goal(7, 1.0, 2.0, "tracking", 12.4, 3.21, np.zeros((0, 2)), np.zeros(0), np.zeros((4, 2), np.float32))
    assert "#7 or 3 others" in memory(page, replace(fake_snapshot(430), goal=goal))


@pytest.mark.parametrize(
    ("total", "least", "verdict"), [(1.0, 0.1, "holds"), (0.9, 0.1, "not normalised yet"), (1.0, -0.1, "broken")]
)
def test_the_attractor_is_checked(page: Page, total: float, least: float, verdict: str) -> None:
    snapshot = fake_snapshot(430)
    assert verdict in memory(page, replace(snapshot, pose_cells=replace(snapshot.pose_cells, total=total, least=least)))


def test_the_memory_tells_how_sure_the_robot_is_and_where_else_it_may_be(page: Page) -> None:
    snapshot = fake_snapshot(430)
    x, y = snapshot.estimate.x, snapshot.estimate.y
    sure = Belief(0.083, (), 0, 0, 0, 12_345, 0, 0)
    words = memory(page, replace(snapshot, belief=sure))
    for told in (
        "'may be off by', '0.08 m'",
        "'may be elsewhere', 'nowhere'",
        "'found out that it was elsewhere', 'never'",
        "12\\xa0345",
    ):
        assert told in words
    assert "islands" not in words
    doubting = replace(
        sure, off_m=np.inf, others=(Hypothesis(x + 3.0, y + 4.0, 0.0, 0.12),), corrected=1, apart=7, joined=2
    )
    words = memory(page, replace(snapshot, belief=doubting))
    for told in ("it does not know", "5.0 m away, likely by 12 %", "'once'", "'submaps merged', '2'"):
        assert told in words
    assert "'experiences on other submaps', '7'" in words
    assert "it has no experience map" in memory(page, replace(snapshot, belief=None))

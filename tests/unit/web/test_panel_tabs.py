"""What each tab of the side panel tells, in words, numbers and pictures."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fake_snapshots import fake_reports, fake_snapshot, fake_walk
from tests.unit.web.office_moments import living
from tests.unit.web.panel_page import Page, memory, told
from web.messages import Belief, Event, Hypothesis, Parameter, Snap, SnapCause
from web.panel.inspected import LINKS
from web.panel.part import clock, number, thousands
from web.panel.senses import RECENT, RecentViews, from_above
from web.panel.tune import hint, step

SNAPSHOT = fake_snapshot(430)
CELLS, SENSES = SNAPSHOT.pose_cells, SNAPSHOT.senses

# ---------------------------------------------------------------- Senses


@pytest.mark.parametrize(
    ("changes", "tone", "words"),
    [
        ({"active_view": 4, "recruited": True}, "new", "new: recruited"),
        ({"active_view": 4, "recruited": False}, "known", "known: recalled"),
        ({"active_view": -1}, "none", "nothing to see"),
        ({"false_positive": True, "false_positives": 3, "best_view": 9}, "false", "false positive 3: rightly #9"),
    ],
)
def test_the_verdict_on_a_view(changes: dict[str, Any], tone: str, words: str) -> None:
    views, _ = told(replace(SNAPSHOT, senses=replace(SENSES, **changes)), "views")
    assert views["verdict"] == {"tone": tone, "words": words}


@pytest.mark.parametrize(
    ("difference", "words", "share"),
    [
        (6.0, "difference to the best view 6.0 (threshold 8.0)", 0.375),
        (99.0, "difference to the best view 99.0 (threshold 8.0)", 1.0),
        (math.inf, "difference: nothing to compare with", 1.0),
    ],
)
def test_the_difference_is_told_against_its_threshold(difference: float, words: str, share: float) -> None:
    views, _ = told(replace(SNAPSHOT, senses=replace(SENSES, difference=difference, threshold=8.0)), "views")
    assert views["difference"] == {"words": words, "share": share, "known": difference == 6.0}


@pytest.mark.parametrize("seen", [np.arange(24, dtype=np.uint8).reshape(4, 6), np.zeros((2, 5, 3), np.uint8)])
def test_the_senses_show_what_the_front_end_sees(seen: np.ndarray) -> None:
    senses = replace(SENSES, front_end="template", seen=seen, seen_words="as it is")
    views, arrays = told(replace(SNAPSHOT, senses=senses), "views")
    assert views["seen"] == {"title": "template now", "words": "the present view: as it is"}
    np.testing.assert_array_equal(arrays["seen"], seen)


def test_cells_from_above_and_by_heading_hold_all_activity() -> None:
    _, arrays = told(SNAPSHOT, "cells")
    assert arrays["by_heading"].sum() == pytest.approx(CELLS.activity.sum(), rel=1e-5)
    columns = np.zeros(CELLS.shape[1:])
    np.add.at(columns, (CELLS.cells[:, 1], CELLS.cells[:, 2]), CELLS.activity)
    drawn = np.zeros(columns.size)
    np.add.at(drawn, arrays["places"], arrays["strength"])
    assert (drawn > 0).sum() <= (columns > 0).sum()
    assert drawn.argmax() == columns.argmax()
    assert set(arrays["packets"]) <= set(range(len(CELLS.packets)))
    bare = replace(CELLS, cells=CELLS.cells[:0], activity=CELLS.activity[:0], packets=())
    assert [len(column) for column in from_above(bare)] == [0, 0, 0]


def test_the_strip_of_cells_is_told_together_with_the_view_beside_it() -> None:
    """Apart they would show two views at once while the robot is fast."""
    page = Page("Senses")
    for tick in (430, 431):
        snapshot = replace(fake_snapshot(tick), run=1)
        seen = replace(snapshot, senses=replace(snapshot.senses, active_view=tick))
        views, _ = page.told(seen, after_s=0.2)["views"]  # which is too early for another picture of the pose cells
        assert (views["active"], views["recent"][-1], views["known"]) == (tick, tick, seen.views)


def test_the_views_that_were_active_lately_are_kept_for_a_run() -> None:
    recent = RecentViews()

    def see(view: int, run: int = 1) -> tuple[int, ...]:
        recent.remember(replace(SNAPSHOT, run=run, senses=replace(SENSES, active_view=view)))
        return recent.numbers

    kept = see(3)
    assert kept == (3,)
    assert see(3) is see(-1) is kept  # the same object: nothing to draw
    assert see(5) == (3, 5)
    for view in range(200):
        see(view)
    assert recent.numbers == tuple(range(200 - RECENT, 200))
    assert see(8, run=2) == (8,)


# ---------------------------------------------------------------- Memory


def test_the_memory_says_why_there_is_nothing() -> None:
    cells = replace(CELLS, packets=())
    bare = replace(SNAPSHOT, events=(), goal=None, relocalisations=0, revisit_consistency=None, pose_cells=cells)
    words = memory(bare)
    assert "no activity yet" in words
    assert "none: click the map" in words
    assert "none yet: no view has been recognised" in words
    assert "agreed with odometry" in memory(replace(bare, revisit_consistency=0.5))
    assert "none recently; 7 so far" in memory(replace(bare, relocalisations=7))


def test_the_memory_tells_packets_goal_and_snaps_with_their_units() -> None:
    packet = CELLS.packets[0]
    assert SNAPSHOT.goal is not None
    goal = replace(SNAPSHOT.goal, experience=7, eta_s=12.4, remaining_m=3.21, places_xy=np.zeros((4, 2), np.float32))
    happened = (Event(1, 65.0, "snap", "snapped 5.6 m"), Event(2, 70.0, "goal", "goal set"))
    causes = (SnapCause(312, 7, 1.2, 0.41, 90, 0.02, 61.3),)
    for snap, why in (
        (
            Snap(65.0, packet, packet, causes),
            "7 looks, 41 % of the injected activity; 90 links there, up to 0.02; learnt 61 s",
        ),
        (Snap(65.0, packet, packet, ()), "none: no view injected there"),
    ):
        words = memory(replace(SNAPSHOT, goal=goal, events=happened, pose_cells=replace(CELLS, last_snap=snap)))
        assert f"x′ {packet.x * CELLS.cell_m:.1f} m" in words
        assert all(told in words for told in ("'12 s'", "'3.2 m'", "#7 or 3 others", "['1:05', 'snapped 5.6 m']"))
        assert "goal set" not in words
        assert "Views that made the snap of 1:05" in words
        assert why in words
        assert ("view 312" in words) == bool(snap.causes)


@pytest.mark.parametrize(
    ("total", "least", "verdict"), [(1.0, 0.1, "holds"), (0.9, 0.1, "not normalised yet"), (1.0, -0.1, "broken")]
)
def test_the_attractor_is_checked(total: float, least: float, verdict: str) -> None:
    assert verdict in memory(replace(SNAPSHOT, pose_cells=replace(CELLS, total=total, least=least)))


def test_the_memory_tells_how_sure_the_robot_is_and_where_else_it_may_be() -> None:
    here, sure = SNAPSHOT.estimate, Belief(0.083, (), 0, 0, 0, 12_345, 0, 0)
    elsewhere = (Hypothesis(here.x + 3.0, here.y + 4.0, 0.0, 0.12),)
    doubting = replace(sure, off_m=np.inf, others=elsewhere, corrected=1, apart=7, joined=2)
    for belief, words in (
        (sure, "'uncertainty', '0.08 m'"),
        (sure, "'rival hypothesis', 'none'"),
        (sure, "'beliefs revised', 'never'"),
        (sure, "12\\xa0345"),
        (replace(sure, places=5), "'hypotheses', '5'"),
        (doubting, "unknown"),
        (doubting, "5.0 m away, 12 %"),
        (doubting, "'once'"),
        (doubting, "'submaps merged', '2'"),
        (doubting, "'experiences on other submaps', '7'"),
        (None, "it has no experience map"),
    ):
        assert words in memory(replace(SNAPSHOT, belief=belief))
    assert "submaps" not in memory(replace(SNAPSHOT, belief=sure))


# ---------------------------------------------------------------- Inspect

INSPECTED: dict[str, tuple[str, str, set[str], tuple[str, ...]]] = {
    "experience": (
        "#12", "active now", {"picture"},
        ("Links to other experiences: 2", "1.50 m at 45°", "following the wall", "confidence 80 %", "1:05", "gone 3 times",
         "not tried yet", "at 0°"),
    ),
    "view": (
        "#7", "not active", {"picture", "now", "camera"},
        ("12.5", "8.0: another view", "[12, '']", "[40, '']", "pose cells linked", "not yet"),
    ),
    "cell": (
        "31, 22", "40 % of all activity", {"by_heading"}, ("3, with 62 %", "[7, '0.050']", "Experiences whose zone"),
    ),
    "why": (
        "1:03", "relocalised by view 7", {"camera", "seen0"},
        ("'1:00', 'view 7 is seen'", "'1:03', 'packet 2 wins'", "[12, '']", "[40, '']"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", INSPECTED)
def test_what_is_inspected_is_told(kind: str) -> None:
    page, (name, words, pictures, told_too) = Page(), INSPECTED[kind]
    inspected, arrays = page.told(replace(SNAPSHOT, inspected=fake_reports()[kind]))["inspected"]
    assert (inspected["kind"], inspected["number"], inspected["words"], set(arrays)) == (kind, name, words, pictures)
    assert [part for part in told_too if part not in str(inspected["sections"])] == []
    assert page.told(SNAPSHOT)["inspected"][0] == {"kind": None}


def test_more_than_there_is_room_for_is_counted() -> None:
    view, experience = fake_reports()["view"], fake_reports()["experience"]
    many = replace(view, experiences=tuple(range(10)))  # type: ignore[type-var]
    inspected, _ = told(replace(SNAPSHOT, inspected=many), "inspected")
    (choices,) = [section["choices"] for section in inspected["sections"] if "choices" in section]
    assert ([number for number, _ in choices["entries"]], choices["more"]) == ([0, 1, 2, 3, 4, 5], 4)
    many = replace(experience, links=experience.links * LINKS)  # type: ignore[type-var, union-attr]
    inspected, _ = told(replace(SNAPSHOT, inspected=many), "inspected")
    (links,) = [section["links"] for section in inspected["sections"] if "links" in section]
    assert (len(links["rows"]), links["more"]) == (LINKS, LINKS)


def test_a_cell_in_which_nothing_is_active_says_so() -> None:
    cell = fake_reports()["cell"]
    still = replace(cell, by_heading=0 * cell.by_heading)  # type: ignore[type-var, union-attr]
    assert told(replace(SNAPSHOT, inspected=still), "inspected")[0]["words"] == "nothing is active here"


def test_what_is_active_now_can_be_chosen() -> None:
    happened = [Event(k, 60.0 + k, kind, "") for k, kind in enumerate(("snap", "goal", "closure", "false"), start=1)]
    snapshot = replace(SNAPSHOT, active_experience=17, events=tuple(happened))
    assert told(snapshot, "active")[0] == {
        "experience": 17, "view": SENSES.active_view,
        "events": [[4, "false", "1:04"], [3, "closure", "1:03"], [1, "snap", "1:01"]],
    }  # fmt: skip
    unseen = replace(SENSES, active_view=-1, best_view=5)
    assert told(replace(snapshot, senses=unseen), "active")[0]["view"] == 5


# ---------------------------------------------------------------- Tick and Truth


def test_stages_to_come_have_no_words_yet() -> None:
    assert told(SNAPSHOT, "walk")[0] == {"at": None, "stages": []}
    passed = [["Image", "This is what the image did."], ["Injection", "This is what the injection did."]]
    assert told(replace(SNAPSHOT, walk=fake_walk(1)), "walk")[0] == {"at": 1, "stages": [*passed, ["Correction", ""]]}


def test_a_tick_s_parts_are_told_against_the_time_there_is() -> None:
    timings, _ = told(SNAPSHOT, "timings")
    assert timings["there_are_ms"] == 100.0
    assert ["view match", 0.25, 0.7] in timings["parts"]
    rate = Parameter("robot.sensor_rate_hz", 20, 20, "", "Hz", 1, 60, "ticks a second", "ours", False)
    assert told(replace(SNAPSHOT, parameters=(rate,)), "timings")[0]["there_are_ms"] == 50.0


def test_the_truth_is_told_in_numbers_and_series() -> None:
    snapshot = fake_snapshot(930)
    assert f"{snapshot.error_map_m:.2f} m" in str(told(snapshot, "numbers"))
    data, arrays = told(snapshot, "series")
    assert data["residual"].startswith(f"{snapshot.series.residual_mm[-1]:.1f} mm and ")
    np.testing.assert_allclose(arrays["odometry_error_m"], snapshot.series.odometry_error_m, rtol=1e-6)
    nothing = replace(snapshot, revisit_consistency=None, series=fake_snapshot(0).series)
    assert "none yet" in str(told(nothing, "numbers"))


# ---------------------------------------------------------------- Office and Tune


def test_what_moves_in_the_office_is_counted() -> None:
    office, _ = told(replace(SNAPSHOT, living=living()), "office")
    assert "1 of 2 doors not open, 1 of 1 lamps lit" in str(office)


def test_every_parameter_explains_itself_and_has_symbol_unit_and_default() -> None:
    by_name = {p.name: p for p in SNAPSHOT.parameters}
    fixed, live, kind = by_name["pose_cells.cells"], by_name["pilot.speed"], by_name["views.kind"]
    assert "Takes effect at reset." in hint(fixed)
    assert "Takes effect" not in hint(live)
    assert all(part in hint(live) for part in ("Range: 0.05 to 0.5 m/s.", "Default: 0.3. Source: "))
    assert "Range" not in hint(kind)
    assert "Range: at most 0.5 m/s." in hint(replace(live, low=None))
    assert "One of: a, b." in hint(replace(kind, choices=("a", "b")))
    steps = [step(fixed), step(live), step(replace(live, low=None)), step(by_name["pilot.wander"])]
    assert steps == [1, pytest.approx(0.002), pytest.approx(0.001), None]
    knobs = {knob["name"]: knob for knob in told(SNAPSHOT, "tune")[0]["knobs"]}
    assert knobs.keys() == by_name.keys()
    told_of = ("symbol", "unit", "default", "live", "lecture", "meaning")
    assert [knobs["pilot.speed"][name] for name in told_of] == ["v", "m/s", 0.3, True, False, "Cruising speed."]


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6))
def test_a_step_is_1_2_or_5_and_at_most_a_hundredth_of_the_range(low: float, span: float) -> None:
    size = step(Parameter("a.b", low, low, "", "", low, low + span, "", "", True))
    assert size is not None
    assert size <= span / 100 * (1 + 1e-6) + 1e-14
    digit = size / 10 ** math.floor(math.log10(size * (1 + 1e-9)))
    assert any(digit == pytest.approx(wanted, rel=1e-6) for wanted in (1, 2, 5, 10))


def test_words_for_numbers() -> None:
    assert (clock(128.9), clock(3599.9), clock(3723.0)) == ("2:08", "59:59", "1:02:03")
    assert (number(None, "m"), number(math.nan, "m"), number(1.234, "m", 2)) == ("-", "-", "1.23 m")
    assert thousands(1234567) == "1\u00a0234\u00a0567"

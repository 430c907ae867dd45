"""The side panel as data: what each tab is sent, in which words, and that no page is sent what it has or does not show."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.fake_snapshots import fake_reports, fake_snapshot, fake_walk
from tests.unit.web.frames import read_frame, read_message
from web.messages import Event, Goal, Parameter, Report, Senses, Snapshot
from web.panel import panel as module
from web.panel.packing import framed, packed
from web.panel.panel import TABS, Panel, PanelReader
from web.panel.senses import RECENT, RecentViews, from_above
from web.panel.tune import hint, step
from web.panel.words import clock, number, thousands
from web.switches import Switches

Told = dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]]


class Page:
    """One page with open tabs; by default, time advances by as much as any part may wait."""

    def __init__(self, panel: Panel, tabs: Collection[str] = TABS) -> None:
        self.panel, self.reader, self.now_s = panel, PanelReader(panel), 100.0
        self.reader.tabs = tabs

    def told(self, snapshot: Snapshot, after_s: float = 2.0) -> Told:
        """Data and arrays by part."""
        self.now_s += after_s
        self.panel.remember(snapshot)
        read = [read_message(message) for message in self.reader.news(snapshot, self.now_s)]
        return {head["part"]: (head["data"], arrays) for head, arrays in read}


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


def words_of(tables: list[dict[str, Any]]) -> str:
    return "\n".join(f"{t['title']}\n{t['rows']}\n{t['empty']}" for t in tables)


# ---------------------------------------------------------------- what travels


@given(
    st.dictionaries(
        st.text("abc", min_size=1, max_size=3),
        hnp.arrays(
            st.sampled_from([np.uint8, np.uint16, np.uint32, np.float32]), hnp.array_shapes(max_dims=2, max_side=9)
        ),
        max_size=4,
    )
)
def test_arrays_arrive_as_they_were(arrays: dict[str, np.ndarray]) -> None:
    head, read = read_frame(framed({"type": "panel"}, {name: packed(array) for name, array in arrays.items()}))
    assert head == {"type": "panel"}
    assert read.keys() == arrays.keys()
    for name, array in arrays.items():
        np.testing.assert_array_equal(read[name], array)


def test_a_camera_s_image_travels_small_and_true() -> None:
    camera = fake_snapshot(430).senses.camera
    image = packed(camera)
    assert image.kind == "jpeg"
    assert len(image.body) < camera.nbytes / 3
    _, read = read_frame(framed({}, {"camera": image}))
    assert np.abs(read["camera"].astype(int) - camera).mean() < 3


def test_what_has_not_changed_is_not_sent(page: Page) -> None:
    snapshot = fake_snapshot(430)
    first = page.told(snapshot)
    assert set(first) == {part.name for part in module.PARTS}
    assert page.told(snapshot) == {}
    assert page.told(replace(snapshot, tick=431)) == {}  # another snapshot with the same content
    brighter = replace(snapshot.senses, camera=255 - snapshot.senses.camera)
    again = page.told(replace(snapshot, senses=brighter))
    assert set(again) == {"views"}
    assert set(again["views"][1]) == {"camera"}  # the other pictures are there


def test_a_part_that_has_lost_a_picture_says_so(page: Page) -> None:
    snapshot = fake_snapshot(430)
    page.reader.tabs = ("Senses",)
    page.told(snapshot)
    (message,) = page.reader.news(replace(snapshot, senses=replace(snapshot.senses, best=None)), page.now_s + 1)[:1]
    head, arrays = read_message(message)
    assert head["has"] == ["camera", "seen"]
    assert not arrays


def test_tabs_that_are_not_open_are_told_nothing_and_told_all_when_they_open(page: Page) -> None:
    snapshot = fake_snapshot(430)
    page.reader.tabs = ("Senses",)
    assert set(page.told(snapshot)) == {"views", "cells"}
    page.reader.tabs = ("Tune", "Truth")
    assert set(page.told(snapshot)) == {"tune", "numbers", "series"}
    page.reader.tabs = ()
    assert page.told(fake_snapshot(431)) == {}


def test_what_comes_too_early_is_told_when_it_is_due(page: Page) -> None:
    page.reader.tabs = ("Memory",)
    page.told(fake_snapshot(430))
    assert page.reader.soon_s is None
    later = replace(fake_snapshot(430), views=1234)
    assert page.told(later, 0.01) == {}
    assert page.reader.soon_s is not None
    assert "1 234" in words_of(page.told(later, 1.0)["memory"][0]["tables"]).replace("\\xa0", " ")
    assert page.reader.soon_s is None


def test_each_content_is_made_once_for_all_who_look(monkeypatch: pytest.MonkeyPatch) -> None:
    panel, made = Panel(Switches()), []
    monkeypatch.setattr(module, "packed", lambda array: (made.append(1), packed(array))[1])
    one, two = Page(panel, ("Senses",)), Page(panel, ("Senses",))
    snapshot = fake_snapshot(430)
    first, second = one.told(snapshot), two.told(snapshot)
    assert len(made) == sum(len(arrays) for _, arrays in first.values())
    assert {name: data for name, (data, _) in first.items()} == {name: data for name, (data, _) in second.items()}


# ---------------------------------------------------------------- senses


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


# ---------------------------------------------------------------- memory


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


@pytest.mark.parametrize(
    ("total", "least", "verdict"), [(1.0, 0.1, "holds"), (0.9, 0.1, "not normalised yet"), (1.0, -0.1, "broken")]
)
def test_the_attractor_is_checked(page: Page, total: float, least: float, verdict: str) -> None:
    snapshot = fake_snapshot(430)
    assert verdict in memory(page, replace(snapshot, pose_cells=replace(snapshot.pose_cells, total=total, least=least)))


# ---------------------------------------------------------------- inspect


def text_of(sections: list[dict[str, Any]]) -> str:
    return str(sections)


@pytest.mark.parametrize("kind", ["experience", "view", "cell"])
def test_what_is_inspected_is_told(page: Page, kind: str) -> None:
    report = fake_reports()[kind]
    told, arrays = page.told(replace(fake_snapshot(430), inspected=report))["inspected"]
    assert told["kind"] == kind
    words = {
        "experience": ("Links to other experiences: 2", "1.50 m at 45°", "following the wall", "confidence 80 %",
                       "1:05", "gone 3 times", "not tried yet", "at 0°"),
        "view": ("12.5", "8.0: another view", "[12, '']", "[40, '']", "pose cells linked", "not yet"),
        "cell": ("3, with 62 %", "[7, '0.050']", "Experiences whose zone"),
    }[kind]  # fmt: skip
    for word in words:
        assert word in text_of(told["sections"]), word
    assert told["number"] == {"experience": "#12", "view": "#7", "cell": "31, 22"}[kind]
    assert told["words"] == {"experience": "active now", "view": "not active", "cell": "40 % of all activity"}[kind]
    assert (
        set(arrays) == {"experience": {"picture"}, "view": {"picture", "now", "camera"}, "cell": {"by_heading"}}[kind]
    )
    assert page.told(fake_snapshot(430))["inspected"][0] == {"kind": None}


def test_more_than_there_is_room_for_is_counted(page: Page) -> None:
    report: Report = replace(fake_reports()["view"], experiences=tuple(range(10)))  # type: ignore[type-var]
    told, _ = page.told(replace(fake_snapshot(430), inspected=report))["inspected"]
    (choices,) = [section["choices"] for section in told["sections"] if "choices" in section]
    assert [number for number, _ in choices["entries"]] == [0, 1, 2, 3, 4, 5]
    assert choices["more"] == 4


def test_what_is_active_now_can_be_chosen(page: Page) -> None:
    snapshot = replace(fake_snapshot(430), active_experience=17)
    assert page.told(snapshot)["active"][0] == {"experience": 17, "view": snapshot.senses.active_view}
    unseen: Senses = replace(snapshot.senses, active_view=-1, best_view=5)
    assert page.told(replace(snapshot, senses=unseen))["active"][0]["view"] == 5


# ---------------------------------------------------------------- tick, truth


def test_stages_to_come_have_no_words_yet(page: Page) -> None:
    assert page.told(fake_snapshot(430))["walk"][0] == {"at": None, "stages": []}
    told = page.told(replace(fake_snapshot(430), walk=fake_walk(1)))["walk"][0]
    assert told["at"] == 1
    assert told["stages"] == [
        ["Image", "This is what the image did."],
        ["Injection", "This is what the injection did."],
        ["Correction", ""],
    ]


def test_a_tick_s_parts_are_told_against_the_time_there_is(page: Page) -> None:
    snapshot = fake_snapshot(430)
    told = page.told(snapshot)["timings"][0]
    assert told["there_are_ms"] == 100.0
    assert ["view match", 0.25, 0.7] in told["parts"]
    rate = Parameter("robot.sensor_rate_hz", 20, 20, "", "Hz", 1, 60, "ticks a second", "ours", False)
    assert page.told(replace(snapshot, parameters=(rate,)))["timings"][0]["there_are_ms"] == 50.0


def test_the_truth_is_told_in_numbers_and_series(page: Page) -> None:
    snapshot = fake_snapshot(930)
    told = page.told(snapshot)
    assert f"{snapshot.error_map_m:.2f} m" in str(told["numbers"][0])
    data, arrays = told["series"]
    assert data["residual"].startswith(f"{snapshot.series.residual_mm[-1]:.1f} mm and ")
    np.testing.assert_allclose(arrays["odometry_error_m"], snapshot.series.odometry_error_m, rtol=1e-6)
    nothing = page.told(replace(snapshot, revisit_consistency=None, series=fake_snapshot(0).series))
    assert "no revisits yet" in str(nothing["numbers"][0])


# ---------------------------------------------------------------- office, tune


def test_every_parameter_explains_itself() -> None:
    by_name = {p.name: p for p in fake_snapshot(0).parameters}
    fixed, live = by_name["pose_cells.cells"], by_name["pilot.speed"]
    assert "Takes effect at reset." in hint(fixed)
    assert "Takes effect" not in hint(live)
    assert "Range: 0.05 to 0.5 m/s." in hint(live)
    assert "Range" not in hint(by_name["views.kind"])
    assert "Range: at most 0.5 m/s." in hint(replace(live, low=None))
    assert "One of: a, b." in hint(replace(by_name["views.kind"], choices=("a", "b")))
    assert step(fixed) == 1
    assert step(live) == pytest.approx(0.002)
    assert step(replace(live, low=None)) == pytest.approx(0.001)
    assert step(by_name["pilot.wander"]) is None


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6))
def test_a_step_is_1_2_or_5_and_at_most_a_hundredth_of_the_range(low: float, span: float) -> None:
    parameter = Parameter("a.b", low, low, "", "", low, low + span, "", "", True)
    size = step(parameter)
    assert size is not None
    assert size <= span / 100 * (1 + 1e-6) + 1e-14
    digit = size / 10 ** math.floor(math.log10(size * (1 + 1e-9)))
    assert any(digit == pytest.approx(wanted, rel=1e-6) for wanted in (1, 2, 5, 10))


def test_knobs_have_symbol_unit_and_default(page: Page) -> None:
    told = page.told(fake_snapshot(430))["tune"][0]["knobs"]
    assert len(told) == len(fake_snapshot(430).parameters)
    (speed,) = [knob for knob in told if knob["name"] == "pilot.speed"]
    assert (speed["symbol"], speed["unit"], speed["default"], speed["live"]) == ("v", "m/s", 0.3, True)


# ---------------------------------------------------------------- words


def test_words_for_numbers() -> None:
    assert (clock(128.9), clock(3599.9), clock(3723.0)) == ("2:08", "59:59", "1:02:03")
    assert number(None, "m") == number(float("nan"), "m") == "-"
    assert number(1.234, "m", 2) == "1.23 m"
    assert thousands(1234567) == "1\u00a0234\u00a0567"

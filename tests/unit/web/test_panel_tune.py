"""The tab Tune: parameters, their steps and words for numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.panel_page import Page
from web.messages import Parameter
from web.panel.panel import Panel
from web.panel.tune import hint, step
from web.panel.words import clock, number, thousands
from web.switches import Switches


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


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


def test_words_for_numbers() -> None:
    assert (clock(128.9), clock(3599.9), clock(3723.0)) == ("2:08", "59:59", "1:02:03")
    assert number(None, "m") == number(float("nan"), "m") == "-"
    assert number(1.234, "m", 2) == "1.23 m"
    assert thousands(1234567) == "1\u00a0234\u00a0567"

"""The tabs Tick and Truth: stages, the time of a tick's parts, and errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot, fake_walk
from tests.unit.web.panel_page import Page
from web.messages import Parameter
from web.panel.panel import Panel
from web.switches import Switches


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


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

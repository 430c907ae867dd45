"""The tab Inspect: what was chosen is told, and what can be chosen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from tests.fake_snapshots import fake_reports, fake_snapshot
from tests.unit.web.panel_page import Page
from web.messages import Event, Report, Senses
from web.panel.panel import Panel
from web.switches import Switches


@pytest.fixture
def page() -> Page:
    return Page(Panel(Switches()))


def text_of(sections: list[dict[str, Any]]) -> str:
    return str(sections)


@pytest.mark.parametrize("kind", ["experience", "view", "cell", "why"])
def test_what_is_inspected_is_told(page: Page, kind: str) -> None:
    report = fake_reports()[kind]
    told, arrays = page.told(replace(fake_snapshot(430), inspected=report))["inspected"]
    assert told["kind"] == kind
    words = {
        "experience": ("Links to other experiences: 2", "1.50 m at 45°", "following the wall", "confidence 80 %",
                       "1:05", "gone 3 times", "not tried yet", "at 0°"),
        "view": ("12.5", "8.0: another view", "[12, '']", "[40, '']", "pose cells linked", "not yet"),
        "cell": ("3, with 62 %", "[7, '0.050']", "Experiences whose zone"),
        "why": ("'1:00', 'view 7 is seen'", "'1:03', 'packet 2 wins'", "[12, '']", "[40, '']"),
    }[kind]  # fmt: skip
    for word in words:
        assert word in text_of(told["sections"]), word
    assert told["number"] == {"experience": "#12", "view": "#7", "cell": "31, 22", "why": "1:03"}[kind]
    assert (
        told["words"]
        == {
            "experience": "active now",
            "view": "not active",
            "cell": "40 % of all activity",
            "why": "relocalised by view 7",
        }[kind]
    )
    assert (
        set(arrays)
        == {
            "experience": {"picture"},
            "view": {"picture", "now", "camera"},
            "cell": {"by_heading"},
            "why": {"camera", "seen0"},
        }[kind]
    )
    assert page.told(fake_snapshot(430))["inspected"][0] == {"kind": None}


def test_more_than_there_is_room_for_is_counted(page: Page) -> None:
    report: Report = replace(fake_reports()["view"], experiences=tuple(range(10)))  # type: ignore[type-var]
    told, _ = page.told(replace(fake_snapshot(430), inspected=report))["inspected"]
    (choices,) = [section["choices"] for section in told["sections"] if "choices" in section]
    assert [number for number, _ in choices["entries"]] == [0, 1, 2, 3, 4, 5]
    assert choices["more"] == 4


def test_what_is_active_now_can_be_chosen(page: Page) -> None:
    happened = [Event(k, 60.0 + k, kind, "") for k, kind in enumerate(("snap", "goal", "closure", "false"), start=1)]
    snapshot = replace(fake_snapshot(430), active_experience=17, events=tuple(happened))
    assert page.told(snapshot)["active"][0] == {
        "experience": 17,
        "view": snapshot.senses.active_view,
        "events": [[4, "false", "1:04"], [3, "closure", "1:03"], [1, "snap", "1:01"]],
    }
    unseen: Senses = replace(snapshot.senses, active_view=-1, best_view=5)
    assert page.told(replace(snapshot, senses=unseen))["active"][0]["view"] == 5

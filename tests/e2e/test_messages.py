"""What the page says by itself: toasts that cover nothing, and the marks on the timeline."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest
from playwright.sync_api import Page

from tests.e2e.browser import box_of, on_screen, open_page, until
from tests.e2e.fake_engine import FakeEngine
from tests.e2e.program import Program
from web.messages import EventKind
from web.viewer.plates.map_plate import ORIGIN, SHEET

pytestmark = pytest.mark.long

CLEAR = """() => {
    const toasts = [...document.querySelectorAll(".toast")].map((toast) => toast.getBoundingClientRect());
    const bars = document.getElementById("editor").hidden ? ".views" : "#editor .bar, #editor .foot";
    const parts = [...document.querySelectorAll(`header, footer, ${bars}`)].map((part) => part.getBoundingClientRect());
    const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
    const inside = (a) => a.left >= 0 && a.right <= innerWidth && a.width > 40;
    return toasts.length > 0 && toasts.every((toast, k) =>
        inside(toast) && [...parts, ...toasts.slice(k + 1)].every((other) => apart(toast, other))); }"""
SAY = "async ([words, options]) => { (await import('/static/ui/words.js')).toast(words, options); }"
LONG = (
    "The robot stays where it is: (3.1, 4.2) is 0.103 m from the wall; the robot needs 0.2 m of free floor around it."
)
Fake = tuple[FakeEngine, str]


def quiet(page: Page) -> None:
    page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")


def toasts(page: Page) -> list[str]:
    """The toasts there are, except the message about a missing graphics card."""
    return [words for words in page.locator(".toast span").all_text_contents() if "graphics card" not in words]


@pytest.mark.parametrize("size", [(1280, 800), (1024, 700), (390, 844), (640, 400)])
def test_toasts_cover_neither_header_nor_buttons_nor_plates_nor_each_other(fake: Fake, browser, size) -> None:
    with open_page(browser, fake[1], *size, light=size[0] == 1024, stage=False) as page:
        if size[0] >= 1024:
            quiet(page)
            page.evaluate(SAY, ["No graphics card in use: the stage moves slowly.", {"notice": True, "stays": True}])
            front = ORIGIN[1] + SHEET[2] - SHEET[1] / 2
            assert box_of(page.locator(".toast"))["y"] >= on_screen(page, "all", (0.0, front, 0.0))[1]
        for k in range(6):
            page.evaluate(SAY, [f"{k}. {LONG}", {"bad": k % 2 == 0, "stays": True}])
            assert page.evaluate(CLEAR)
        assert f"5. {LONG}" in toasts(page)  # the newest is always shown
        assert len(toasts(page)) >= 3 or size[1] < 500  # as many as there is room for


def test_toasts_cover_none_of_the_editor_s_buttons(program: Program, browser) -> None:
    with open_page(browser, program.url, stage=False) as page:
        page.click("#edit")
        page.evaluate(SAY, [LONG, {"stays": True}])
        assert page.evaluate(CLEAR)


def test_a_toast_has_the_sign_of_its_kind_and_stays_for_as_long_as_reading_needs(fake: Fake, browser) -> None:
    with open_page(browser, fake[1], stage=False) as page:
        quiet(page)
        page.clock.install()
        page.clock.pause_at(page.evaluate("() => Date.now()") + 1000)
        for words, options in ("Short.", {}), (LONG, {"bad": True}), ("It stays.", {"stays": True, "notice": True}):
            page.evaluate(SAY, [words, options])
        signs = page.locator(".toast").evaluate_all(
            "toasts => toasts.map((toast) => toast.querySelector('use').getAttribute('href')).sort()"
        )
        assert signs == ["#i-check", "#i-info", "#i-warn"]
        page.clock.run_for(3900)
        assert len(toasts(page)) == 3
        page.clock.run_for(1500)
        assert toasts(page) == [LONG, "It stays."]
        page.hover(".toast.bad")
        page.clock.run_for(60_000)
        assert toasts(page) == [LONG, "It stays."]  # somebody points at it
        page.mouse.move(5, 5)
        page.clock.run_for(60_000)
        assert toasts(page) == ["It stays."]


LOOKS = """() => [...document.querySelectorAll("#timeline .mark")].map((mark) => {
    const style = getComputedStyle(mark), open = mark.classList.contains("open");
    return [open ? style.stroke : style.fill, open, mark.getAttribute("d")].join(); })"""


def test_no_two_kinds_of_events_look_the_same(fake: Fake, browser) -> None:
    engine, url = fake
    kinds = get_args(EventKind)
    engine.shown, engine.events, engine.tick = {"events": ()}, [], 40
    for kind in kinds:
        engine.note(kind, f"text of {kind}")
    spread = tuple(replace(event, time_s=0.2 * k) for k, event in enumerate(engine.events))
    with open_page(browser, url, 1600, 900, stage=False) as page:
        engine.shown = {"events": spread, "run": 77}
        until(page, "n => document.querySelectorAll('#timeline .mark').length === n", argument=len(kinds))
        looks = page.evaluate(LOOKS)
    assert not [look for look in looks if look.startswith(("none", "rgb(0, 0, 0)"))]
    assert len(set(looks)) == len(kinds)


@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_a_mark_says_what_happened(fake: Fake, browser, size) -> None:
    engine, url = fake
    engine.shown, engine.events, engine.tick = {"events": ()}, [], 37_230  # an hour and more
    engine.note("recovered", "knows where it is 4.2 s after the kidnap")
    engine.shown = {"events": tuple(engine.events), "run": 78, "running": False}
    with open_page(browser, url, *size, stage=False) as page:
        until(page, "() => document.querySelectorAll('#timeline .mark').length === 1")
        where = (
            page.evaluate("""() => { const box = document.querySelector("#timeline .mark").getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2]; }""")
        )  # at once, since it is drawn anew all the time
        (page.touchscreen.tap if size[0] < 500 else page.mouse.move)(*where)
        page.wait_for_timeout(1200)  # the timeline is drawn anew twice meanwhile
        assert page.inner_text("#event-tip") == "1:02:03 recovered: knows where it is 4.2 s after the kidnap"
        tip = box_of(page.locator("#event-tip"))
        assert tip["x"] >= 0
        assert tip["x"] + tip["width"] <= size[0]
        page.mouse.move(200, 100)
        page.mouse.click(8, size[1] - 4)
        assert not page.is_visible("#event-tip")

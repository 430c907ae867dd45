"""What the page says by itself: in the line beneath the stage, one thing at a time, and by the marks on the timeline."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import box_of, open_page, until
from tests.e2e.fake_engine import FakeEngine
from web.messages import EventKind

pytestmark = pytest.mark.long

SHOWN = """() => [...document.getElementById("line").children].filter((part) => part.offsetHeight > 0)
    .map((part) => part.id || part.className)"""
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
def test_one_thing_is_told_at_a_time_and_the_stage_keeps_its_size(fake: Fake, browser, size) -> None:
    with open_page(browser, fake[1], *size, light=size[0] == 1024, stage=False, first=True) as page:
        quiet(page)
        assert page.evaluate(SHOWN) == ["first"]
        page.evaluate(SAY, [LONG, {"bad": True}])
        assert page.evaluate(SHOWN) == ["alerts"]  # what went wrong goes before all else
        page.keyboard.press("Escape")
        page.click("#first-close")
        quiet(page)
        assert page.evaluate(SHOWN) == ["hints"]
        stage = box_of(page.locator("#stage"))
        for words, options, shown in ("Short.", {}, "toasts"), (LONG, {}, "toasts"), (LONG, {"bad": True}, "alerts"):
            page.evaluate(SAY, [words, options])
            assert page.evaluate(SHOWN) == [shown]
            assert box_of(page.locator("#stage")) == stage
            assert toasts(page) == [words]


def test_what_was_refused_is_not_wiped_away_by_what_was_done(fake: Fake, browser) -> None:
    with open_page(browser, fake[1], stage=False) as page:
        quiet(page)
        for words, options in ((LONG, {"bad": True}), ("Done.", {}), ("Done again.", {})):
            page.evaluate(SAY, [words, options])
        assert set(toasts(page)) == {LONG, "Done again."}
        assert page.evaluate(SHOWN) == ["alerts"]


def test_a_toast_has_the_sign_of_its_kind_and_stays_for_as_long_as_reading_needs(fake: Fake, browser) -> None:
    with open_page(browser, fake[1], stage=False) as page:
        quiet(page)
        page.clock.install()
        page.clock.pause_at(page.evaluate("() => Date.now()") + 1000)
        for words, options, name in ("It stays.", {"stays": True, "notice": True}, "info"), ("Short.", {}, "check"):
            page.evaluate(SAY, [words, options])
            expect(page.locator(".toast > .icon use").last).to_have_attribute("href", f"#i-{name}")
        page.clock.run_for(4600)
        assert toasts(page) == ["It stays."]
        page.evaluate(SAY, [LONG, {"bad": True}])
        page.clock.run_for(4600)
        assert LONG in toasts(page)
        page.hover(".toast.bad")
        page.clock.run_for(60_000)
        assert LONG in toasts(page)  # somebody points at it
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

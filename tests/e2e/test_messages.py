"""What the page says by itself: refusals and notices as toasts that cover nothing, and the marks on the timeline."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from playwright.sync_api import expect

from sim2d import load_world
from tests.e2e.browser import at_each, box_of, on_screen, open_page, show, told, until
from tests.e2e.fake_engine import FakeEngine, fake_program
from web.messages import EventKind
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.plates.map_plate import ORIGIN as MAP_ORIGIN
from web.viewer.plates.map_plate import SHEET as MAP_SHEET
from web.viewer.plates.office_plate import ORIGIN as OFFICE_ORIGIN

CLEAR = """() => {
    const toasts = [...document.querySelectorAll(".toast")].map((toast) => toast.getBoundingClientRect());
    const parts = [...document.querySelectorAll("header, .views, footer")].map((part) => part.getBoundingClientRect());
    const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
    const inside = (a) => a.left >= 0 && a.right <= innerWidth && a.width > 40;
    return toasts.length > 0 && toasts.every((toast, k) =>
        inside(toast) && [...parts, ...toasts.slice(k + 1)].every((other) => apart(toast, other))); }"""
SAY = "async ([words, options]) => { (await import('/static/elements/toasts.js')).toast(words, options); }"
LONG = (
    "The robot stays where it is: (3.1, 4.2) is 0.103 m from the wall; the robot needs 0.2 m of free floor around it."
)


@pytest.fixture(scope="module")
def fake() -> Iterator[tuple[FakeEngine, str]]:
    with fake_program() as made:
        yield made


def toasts(page) -> list[str]:
    """The toasts there are, except the message about a missing graphics card."""
    return [words for words in page.locator(".toast span").all_text_contents() if "graphics card" not in words]


# ---------------------------------------------------------------- toasts


@pytest.mark.long
@pytest.mark.parametrize("size", [(1280, 800), (1024, 700), (390, 844), (640, 400)])
def test_toasts_cover_neither_header_nor_view_buttons_nor_each_other(fake, browser, size) -> None:
    with open_page(browser, fake[1], *size, light=size[0] == 1024, stage=False) as page:
        for k in range(6):
            page.evaluate(SAY, [f"{k}. {LONG}", {"bad": k % 2 == 0, "stays": True}])
            assert page.evaluate(CLEAR)
        assert f"5. {LONG}" in toasts(page)  # the newest is always shown
        assert len(toasts(page)) >= 3 or size[1] < 500  # as many as there is room for


@pytest.mark.long
def test_a_toast_stays_for_as_long_as_reading_needs(fake, browser) -> None:
    with open_page(browser, fake[1], stage=False) as page:
        page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
        page.clock.install()
        page.clock.pause_at(page.evaluate("() => Date.now()") + 1000)
        page.evaluate(SAY, ["Short.", {}])
        page.evaluate(SAY, [LONG, {"bad": True}])
        page.evaluate(SAY, ["It stays.", {"stays": True}])
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


@pytest.mark.long
def test_what_was_done_what_went_wrong_and_a_notice_have_signs_of_their_own(fake, browser) -> None:
    with open_page(browser, fake[1]) as page:
        for words, options in (("Done.", {}), ("Wrong.", {"bad": True}), ("A notice.", {"notice": True})):
            page.evaluate(SAY, [words, {"stays": True, **options}])
        told(page, "No graphics card")  # the test's browser has none
        sign = "toasts => toasts.map((toast) => [toast.dataset.text, toast.querySelector('use').getAttribute('href')])"
        signs = dict(page.locator(".toast").evaluate_all(sign))
        assert {"Done.": "#i-check", "Wrong.": "#i-warn", "A notice.": "#i-info"}.items() <= signs.items()
        assert all(sign == "#i-info" for words, sign in signs.items() if "graphics card" in words)


@pytest.mark.long
def test_a_toast_stands_beneath_the_plates(fake, browser) -> None:
    front = MAP_ORIGIN[1] + MAP_SHEET[2] - MAP_SHEET[1] / 2
    with open_page(browser, fake[1], stage=False) as page:
        page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
        page.evaluate(SAY, ["No graphics card in use: the stage moves slowly.", {"notice": True, "stays": True}])
        for size in at_each(page, [(1280, 800), (1024, 700), (1440, 900)]):
            toast = box_of(page.locator(".toast"))
            assert toast["y"] >= on_screen(page, "all", (0.0, front, 0.0))[1], size


@pytest.mark.long
def test_what_the_stage_refuses_is_told_to_whoever_did_it(program, browser) -> None:
    with open_page(browser, program.url, stage=False):  # a page that is alive has a state
        state = program.state()
    robot, world = state["robot"], load_world(state["world"])
    fit = OfficeFit(world.bounds)

    def in_office(x: float, y: float) -> tuple[float, float, float]:
        on_plate = fit.to_plate(np.array([[x, y]]))[0]
        return OFFICE_ORIGIN[0] + on_plate[0], OFFICE_ORIGIN[1] + on_plate[1], OFFICE_ORIGIN[2] + 0.15

    with open_page(browser, program.url) as one, open_page(browser, program.url, 900, 700, stage=False) as two:
        show(one, "office")
        wall = world.walls[0]
        one.mouse.move(*on_screen(one, "office", in_office(robot["x"], robot["y"])))
        one.wait_for_timeout(500)
        one.mouse.down()
        for share in np.linspace(0.2, 1, 6):
            x, y = robot["x"] + share * (wall.x1 - robot["x"]), robot["y"] + share * (wall.y1 - robot["y"])
            one.mouse.move(*on_screen(one, "office", in_office(x, y)))
            one.wait_for_timeout(80)
        one.mouse.up()
        told(one, "The robot stays where it is")
        assert program.state()["robot"] == robot
        expect(one.locator(".toast", has_text="The robot stays where it is")).to_have_count(0)  # a click would hit it
        show(one, "map")
        one.mouse.click(*on_screen(one, "map", (MAP_ORIGIN[0], MAP_ORIGIN[1] - 4.4, MAP_ORIGIN[2] + NODE_Z)))
        told(one, "No goal set: that is beside the map")
        assert two.locator("#alerts .toast").count() == 0
        one.click("#edit")
        one.evaluate(SAY, [LONG, {"stays": True}])
        assert one.evaluate(CLEAR.replace("header, .views, footer", "header, #editor .bar, #editor .foot, footer"))


# ---------------------------------------------------------------- the timeline


def test_every_event_has_a_name_a_mark_and_a_place_in_the_legend(fake, browser) -> None:
    engine, url = fake
    kinds = set(get_args(EventKind))  # the types say that no other is noted
    assert {"snap", "kidnap", "fault", "unreachable", "brain"} <= kinds
    engine.shown, engine.events, engine.tick = {"events": ()}, [], 40
    with open_page(browser, url, 1600, 900, stage=False) as page:
        named = page.evaluate("async () => (await import('/static/model/event_kinds.js')).kinds")
        assert kinds <= set(named)
        for kind in named:
            engine.note(kind, f"text of {kind}")
        engine.note("never heard of", "something new")
        spread = tuple(replace(event, time_s=0.2 * k) for k, event in enumerate(engine.events))
        engine.shown = {"events": spread, "run": 77}
        until(page, "n => document.querySelectorAll('#timeline .mark').length === n", argument=len(named) + 1)
        looks = page.evaluate("""() => [...document.querySelectorAll("#timeline .mark")].map((mark) => {
            const style = getComputedStyle(mark);
            return [mark.classList.contains("open") ? style.stroke : style.fill, mark.outerHTML.includes("open"),
                mark.getAttribute("d")]; })""")
        assert all(colour not in ("none", "rgb(0, 0, 0)") for colour, _, _ in looks)
        assert len({tuple(look) for look in looks}) == len(looks)  # no two look the same
        listed = page.text_content("#events") or ""
        page.keyboard.press("?")
        assert page.locator("#legend li").count() == len(named)
        assert all(words.strip() for words in page.locator("#legend li").all_text_contents())
        page.keyboard.press("?")
        assert "never heard of: something new" in listed


@pytest.mark.long
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_a_mark_says_what_happened(fake, browser, size) -> None:
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
        if size[0] < 500:
            page.touchscreen.tap(*where)
        else:
            page.mouse.move(*where)
        page.wait_for_timeout(1200)  # the timeline is drawn anew twice meanwhile
        assert page.inner_text("#event-tip") == "1:02:03 recovered: knows where it is 4.2 s after the kidnap"
        tip = box_of(page.locator("#event-tip"))
        assert tip["x"] >= 0
        assert tip["x"] + tip["width"] <= size[0]
        page.mouse.move(200, 100)
        page.mouse.click(8, size[1] - 4)
        assert not page.is_visible("#event-tip")

"""The header and the room for the plates at the usual screen sizes, in every state: nothing overlaps, nothing is cut off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests import patience
from tests.e2e.browser import at_each, open_page, until
from tests.fake_snapshots import SNAP_EVERY, fake_snapshot
from web.messages import Closure
from web.panel.panel import TABS

pytestmark = pytest.mark.long

SIZES = [(1024, 768), (1280, 800), (1366, 768), (1920, 1080), (390, 844), (360, 740), (900, 700), (761, 600)]
SIZES += [(1400, 900), (1440, 900), (1480, 900), (1600, 900), (1679, 900), (1680, 900), (1800, 900)]
SIZES += [(640, 400), (683, 384), (960, 540)]  # 1280, 1366 and 1920 pixels wide, enlarged twice
CALM = fake_snapshot(40)
TORN = fake_snapshot(SNAP_EVERY + 1)
assert CALM.goal is not None
FAR = replace(CALM.goal, remaining_m=123.4, eta_s=3590.0)
PLAIN = {"time_s": 45_296.0, "goal": None, "mode": "explore", "lost": False, "running": True, "fault": None}
PLAIN |= {"pose_cells": CALM.pose_cells, "worlds": (("office", "Open-plan office, 10 x 8 m"),)}
STATES: dict[str, dict[str, Any]] = {
    "exploring": {},
    "lost: 2 packets": {"lost": True, "pose_cells": TORN.pose_cells, "goal": replace(FAR, lost=True), "mode": "goal"},
    "going to the goal": {"goal": FAR, "mode": "goal"},
    "by dead reckoning": {"goal": replace(FAR, state="coasting"), "mode": "goal"},
    "looking for a route": {"goal": replace(FAR, state="exploring"), "mode": "goal"},
    "at the goal": {"goal": replace(FAR, state="arrived"), "mode": "goal"},
    "no route to the goal": {"goal": replace(FAR, state="unreachable", eta_s=None), "mode": "goal"},
    "in a long tick": {"fault": "the tick is taking more than 2 s; the session goes on when it has ended", "goal": FAR},
    "stopped by a fault": {"fault": "ZeroDivisionError: division by zero", "running": False, "goal": FAR},
    "paused": {"running": False, "goal": FAR},
    "driving by hand": {"mode": "manual", "goal": FAR},
}
SAYS = """words => document.querySelector("#status span").textContent === words
    && document.getElementById("clock").textContent === "12:34:56" """
# Every visible part: its box against all others and against the header, and whether its words are complete.
WRONG = """() => {
    const wrong = [], header = document.querySelector("header"), frame = header.getBoundingClientRect();
    const parts = [...header.querySelectorAll(".wordmark, button, select, summary, time, .chip, .chip > span, .chip b")]
        .filter((part) => part.checkVisibility() && part.getBoundingClientRect().width && !part.closest(".pop"));
    const name = (part) => part.id || part.className || part.textContent;
    for (const part of parts) {
        const box = part.getBoundingClientRect();
        if (part.scrollWidth > part.clientWidth && part.clientWidth) wrong.push(`${name(part)} is cut`);
        if (box.left < frame.left || box.right > frame.right || box.top < frame.top || box.bottom > frame.bottom)
            wrong.push(`${name(part)} sticks out`);
        for (const other of parts) {
            if (other === part || part.contains(other) || other.contains(part)) continue;
            const its = other.getBoundingClientRect();
            const across = Math.min(box.right, its.right) - Math.max(box.left, its.left);
            const down = Math.min(box.bottom, its.bottom) - Math.max(box.top, its.top);
            if (across > 0.5 && down > 0.5) wrong.push(`${name(part)} covers ${name(other)}`);
        }
    }
    if (frame.right > innerWidth || header.scrollWidth > header.clientWidth) wrong.push("the header is too wide");
    const words = document.querySelector("#status span").getBoundingClientRect();
    if (words.width < 40) wrong.push("the chip says nothing");
    const pen = document.createElement("canvas").getContext("2d"), world = document.getElementById("world");
    for (const part of [world, document.getElementById("explore"), document.getElementById("kidnap")]) {
        const style = getComputedStyle(part), arrow = part === world ? 12 : 0;
        const text = arrow ? world.selectedOptions[0].text : part.innerText.trim();
        const room = part.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - arrow;
        pen.font = style.font;
        if (!part.checkVisibility() || innerWidth <= 860) continue;
        if (pen.measureText(text).width > room + 1) wrong.push(`${part.id} does not say ${text}`);
    }
    return wrong;
}"""


def test_all_of_the_header_shows_at_every_size_in_every_state(fake, browser) -> None:
    engine, url = fake
    heights: dict[tuple[int, int], set[float]] = {size: set() for size in SIZES}
    with open_page(browser, url, stage=False) as page:
        for size in SIZES:
            page.set_viewport_size({"width": size[0], "height": size[1]})
            for words, changes in STATES.items():
                engine.shown = PLAIN | changes
                until(page, SAYS, argument=words)
                assert page.evaluate(WRONG) == [], (words, size)
                heights[size].add(page.evaluate("() => document.querySelector('header').offsetHeight"))
    assert {size: len(seen) for size, seen in heights.items()} == dict.fromkeys(SIZES, 1)  # the plates do not jump


def stage_room(page: Page) -> dict[str, Any]:
    """Which part of the window the plates have, and whether the panel is there; viser's own panel never is."""
    return page.evaluate("""() => {
        const inside = document.getElementById("stage").contentDocument;
        const theirs = inside.querySelector("[data-dock-region], .mantine-Paper-root[style*='fixed']");
        return {height: document.querySelector("main").offsetHeight / innerHeight,
            canvas: inside.querySelector("canvas").getBoundingClientRect().width / innerWidth,
            panel: document.getElementById("panel").checkVisibility(),
            theirs: theirs?.checkVisibility() ?? false}; }""")


@pytest.mark.parametrize("size", [(640, 400), (800, 500), (390, 844)])
def test_in_a_narrow_window_the_panel_comes_only_when_called(fake, browser, size) -> None:
    engine, url = fake
    engine.shown = PLAIN
    with open_page(browser, url, *size, stage=size[0] == 800) as page:
        until(page, "() => document.getElementById('stage').contentDocument.querySelector('canvas').clientWidth > 0")
        room = stage_room(page)
        assert not room["panel"]
        assert not room["theirs"]
        assert room["canvas"] > 0.99
        assert room["height"] > 0.5
        page.click("#panels")
        opened = stage_room(page)
        assert opened["panel"]
        assert opened["canvas"] > 0.99  # a sheet over the plates, which keep their place
        page.get_by_role("button", name="Hide the panel").click()
        assert not stage_room(page)["panel"]
        if size[0] > 760:
            page.set_viewport_size({"width": 1280, "height": 800})
            until(page, "() => document.body.dataset.panels === 'true'")
            assert stage_room(page)["panel"]
            beside = "() => document.getElementById('stage').clientWidth === innerWidth - 340"
            until(page, beside)
            page.keyboard.press("p")  # its room goes to the plates
            until(page, "() => document.getElementById('stage').clientWidth === innerWidth")
            page.click("#panel-show")
            until(page, beside)


def test_a_loop_closure_can_be_played_again(fake, browser) -> None:
    engine, url = fake
    plain = fake_snapshot(40)
    before = plain.map.xy[:50]
    closure = Closure(77, 63.0, 49, 3, plain.map.links[(plain.map.links < 50).all(1)], before, before + 0.5, 0.71)
    with open_page(browser, url) as page:
        expect(page.locator("#replay")).to_be_hidden()
        engine.shown = PLAIN | {"closures": (closure,)}
        expect(page.locator("#replay")).to_be_visible()
        until(page, "() => document.getElementById('replay').title.includes('moved the map by 0.7 m')")
        page.click("#replay")
        page.keyboard.press("r")
        patience.until(lambda: page.wait_for_timeout(50) or engine.viewer.replayed == [77, 77])


def test_all_tabs_of_the_panel_stand_on_one_row_in_full(fake, browser) -> None:
    with open_page(browser, fake[1], stage=False) as page:
        expect(page.get_by_role("tab")).to_have_count(len(TABS))
        for size in at_each(page, [(1280, 800), (1024, 768), (390, 844), (360, 740)]):
            if not page.locator("#panel").is_visible():
                page.click("#panels")
            boxes = page.get_by_role("tab").evaluate_all("""tabs => tabs.map((tab) => {
                const box = tab.getBoundingClientRect();
                return [box.top, box.left, box.right, tab.scrollWidth > tab.clientWidth]; })""")
            assert len({top for top, *_ in boxes}) == 1, size
            assert all(0 <= left < right <= size[0] and not cut for _, left, right, cut in boxes), size

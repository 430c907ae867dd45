"""`/?watch`, the second screen: it shows what the main page shows, and whatever is done there changes nothing."""

from __future__ import annotations

import urllib.request
from typing import Any

import numpy as np
import orjson
import pytest
from playwright.sync_api import expect

from tests.e2e.browser import at_each, box_of, on_screen, open_page, show, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import node_on_stage, robot_on_stage
from tests.patience import PATIENCE_S

KEYS = ["k", "e", " ", ".", ",", "b", "j", "x", "m", "i", "n", "h", "o", "c", "g", "/", "ArrowUp", "w", "PageDown"]
# What whoever opens the console could try: every way from the page to the server, with the page's own id.
TRIES = """async () => {
    const { page } = await import("/static/watch/watch.js");
    const post = (body) => fetch("/api/commands", {
        method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    const answers = [(await post({ type: "kidnap" })).status, (await post({ type: "resume" })).status];
    const socket = new WebSocket(`ws://${location.host}/api/stream?page=${page}`);
    await new Promise((open) => (socket.onopen = open));
    for (const [id, type] of ["kidnap", "resume", "step", "switch", "end_lesson"].entries()) {
        const answer = new Promise((take) => socket.addEventListener("message", ({ data }) => {
            const told = typeof data === "string" ? JSON.parse(data) : {};
            if (told.type === "answer" && told.id === id) take(told.status);
        }));
        socket.send(JSON.stringify({ type, id, ticks: 1 }));
        answers.push(await answer);
    }
    socket.close();
    return answers;
}"""


@pytest.fixture(scope="module")
def drawn(program: Program) -> Program:
    """A run with a map, paused."""
    program.command("step", ticks=1000)
    return program


def moment(program: Program) -> tuple[Any, ...]:
    """The whole session as a hash, the orders that led to it, and all that the page is told of it."""
    request = urllib.request.Request(f"{program.url}api/situation", b"{}", {"Content-Type": "application/json"})
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        made = orjson.loads(answer.read())
    return made["state_hash"], made["orders"], made["tick"], program.state(full=True)


def dragged(page, start: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*start)
    page.wait_for_timeout(500)
    page.mouse.down()
    for share in np.linspace(0.1, 1, 6):
        page.mouse.move(start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))
        page.wait_for_timeout(80)
    page.wait_for_timeout(300)
    page.mouse.up()


@pytest.mark.long
def test_keys_clicks_drags_and_requests_change_nothing(drawn, browser):
    with open_page(browser, f"{drawn.url}?watch", forbidden=True) as page:
        until(page, "() => document.querySelector('#events').textContent !== ''")
        events = page.locator("#events").inner_text()
        before = moment(drawn)
        for key in KEYS:
            page.keyboard.press(key)
        show(page, "map")
        nodes = np.array(before[3]["map"]["xy"])
        far = nodes[np.argmax(np.linalg.norm(nodes - nodes[-1], axis=1))]
        at = on_screen(page, "map", node_on_stage(drawn, far, nodes))
        page.mouse.click(*at)
        page.keyboard.down("Shift")
        page.mouse.click(*at)
        page.keyboard.up("Shift")
        show(page, "office")
        robot = before[3]["robot"]
        places = [(robot["x"], robot["y"]), (robot["x"] + 0.6, robot["y"] + 0.6)]
        dragged(page, *(on_screen(page, "office", robot_on_stage(before[3], *place)) for place in places))
        line = box_of(page.locator("#timeline"))
        page.mouse.click(line["x"] + 0.3 * line["width"], line["y"] + 0.5 * line["height"])
        assert page.evaluate(TRIES) == [403] * 7
        page.wait_for_timeout(500)
        assert moment(drawn) == before
        assert page.locator("#events").inner_text() == events
        with open_page(browser, drawn.url) as main:  # the same click on the main page is a goal
            show(main, "map")
            main.mouse.click(*on_screen(main, "map", node_on_stage(drawn, far, nodes)))
            drawn.wait(lambda state: state["goal"] is not None)
        expect(page.locator("#goal")).to_be_visible()
        drawn.command("cancel_goal")


@pytest.mark.long
@pytest.mark.parametrize("sizes", [[(1920, 1080), (1280, 720)], [(390, 844)]], ids=["screens", "phone"])
def test_nothing_steers(drawn, browser, sizes):
    steers = "header button:visible, header select:enabled:visible, .aids button:visible, footer button:visible"
    with open_page(browser, f"{drawn.url}?watch", *sizes[0], stage=False) as page:
        for size in at_each(page, sizes):
            left = {name for part in page.locator(steers).all() if (name := part.get_attribute("id"))}
            assert left <= {"theme", "follow", "zoom-out", "zoom-in", "zoom-all", "panels"}, size
            assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), size

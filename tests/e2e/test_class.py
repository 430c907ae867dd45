"""`ratslam run --class`: phones in the network vote and look on, and can do nothing else."""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.e2e.browser import at_each, open_page, until
from tests.e2e.layout import boxes, findings
from tests.e2e.program import Program
from tests.patience import PATIENCE_S
from web.http.connections import CannotListen, class_socket

pytestmark = pytest.mark.long


POST = """async (body) => (await fetch("/api/commands",
    { method: "POST", body, headers: { "Content-Type": "application/json" } })).status"""


class School(Program):
    """A program with a door for a class, and a lesson whose question is open."""

    def __init__(self) -> None:
        super().__init__("--port", "0", "--seed", "5", "--paused", "--class", "--class-port", "0", *_where())
        found = re.search(r"A class votes at (http://(\S+):(\d+)/)", "".join(self.said))
        assert found is not None
        self.door, self.address = found[1], found[2]
        self.command("begin_lesson", name="packet")
        self.wait(lambda state: state["lesson"]["state"] == "predict")


def _where() -> tuple[str, ...]:
    """The address of this machine in its network; one that is in none must do with its own."""
    try:
        class_socket(None, 0).close()
    except CannotListen:
        return ("--class-address", "127.0.0.1")
    return ()


@pytest.fixture(scope="module")
def school() -> Iterator[School]:
    made = School()
    yield made
    assert made.stop() == 0


def test_a_phone_votes_and_the_main_page_shows_the_bars_and_presented_the_address(
    school: School, browser: Browser
) -> None:
    with open_page(browser, school.url, 1280, 720, stage=False) as main:
        until(main, "() => document.querySelectorAll('.option').length > 1")
        expect(main.locator(".vote-link a")).to_have_attribute("href", school.door)
        with browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True) as context:
            faults, phone = list[str](), context.new_page()
            phone.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
            phone.on("pageerror", lambda error: faults.append(str(error)))
            phone.goto(school.door)
            phone.locator(".option").nth(1).tap()
            expect(phone.locator("#vote-said")).to_contain_text("Your vote counts")
            assert (findings(phone), faults) == ([], [])
        expect(main.locator(".option .count").nth(1)).to_have_text("1")
        assert main.evaluate("() => document.querySelectorAll('.option .bar')[1].style.width") == "100%"
        expect(main.locator("#lesson-class")).to_be_hidden()
        main.keyboard.press("z")
        expect(main.locator("#lesson-class a")).to_have_text(school.door.removeprefix("http://").removesuffix("/"))
        until(main, "() => document.querySelector('#lesson-class img').naturalWidth > 0")
        for size in at_each(main, [(1280, 720), (1920, 1080)]):
            low = main.evaluate("() => document.querySelector('.option:last-of-type').getBoundingClientRect().bottom")
            foot = main.evaluate("() => document.querySelector('#lesson .foot').getBoundingClientRect().top")
            assert low <= foot, size
            assert boxes(main) + findings(main) == [], size


def test_a_class_looks_on_and_reaches_nothing_else(school: School, browser: Browser) -> None:
    with open_page(browser, f"{school.door}?watch", forbidden=True) as page:
        expect(page.locator("#lesson-title")).to_have_text("A packet moves")
        expect(page.locator("#lesson-class a")).to_be_visible()
        before = school.state()
        page.keyboard.press("k")
        page.keyboard.press("Space")
        assert page.evaluate(POST, '{"type": "resume"}') == 403
        assert school.state() == before
    if school.address != "127.0.0.1":
        with pytest.raises(OSError), socket.create_connection((school.address, school.port), timeout=PATIENCE_S):
            pass

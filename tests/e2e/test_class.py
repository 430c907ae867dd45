"""`ratslam run --class`: phones in the network vote and look on, and can do nothing else."""

from __future__ import annotations

import re
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import at_each, calm, open_page, until
from tests.e2e.layout import findings
from tests.e2e.program import Program
from tests.patience import PATIENCE_S
from web.http.listening import CannotListen, class_socket


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


def pupil(browser: Browser, url: str, faults: list[str]) -> Page:
    """A phone with the page for votes."""
    page = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True).new_page()
    page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(url)
    return page


@pytest.mark.long
def test_phones_vote_and_the_main_page_shows_the_bars(school, browser):
    faults: list[str] = []
    with open_page(browser, school.url, stage=False) as main:
        until(main, "() => document.querySelectorAll('.option').length > 1")
        expect(main.locator(".vote-link a")).to_have_attribute("href", school.door)
        first, second = (pupil(browser, school.door, faults) for _ in range(2))
        first.locator(".option").nth(1).click()
        expect(first.locator("#vote-said")).to_contain_text("Your vote counts")
        expect(main.locator(".option .count").nth(1)).to_have_text("1")
        second.locator(".option").nth(0).click()
        expect(main.locator(".option .count").nth(0)).to_have_text("1")
        expect(main.locator(".class-votes")).to_have_text("2 votes")
        first.locator(".option").nth(0).click()  # a browser counts once
        expect(main.locator(".option .count").nth(0)).to_have_text("2")
        expect(main.locator(".option .count").nth(1)).to_have_text("")
        assert main.evaluate("() => document.querySelector('.option .bar').style.width") == "100%"
        assert findings(first) == []
        for page in (first, second):
            page.context.close()
    assert faults == []


@pytest.mark.long
def test_the_presented_card_shows_the_address_large_and_as_a_code(school, browser):
    with open_page(browser, school.url, 1280, 720, stage=False) as main:
        until(main, "() => document.querySelectorAll('.option').length > 1")
        expect(main.locator("#lesson-class")).to_be_hidden()
        main.keyboard.press("z")
        expect(main.locator("#lesson-class a")).to_have_text(school.door.removeprefix("http://").removesuffix("/"))
        until(main, "() => document.querySelector('#lesson-class img').naturalWidth > 0")
        for size in at_each(main, [(1280, 720), (1920, 1080)]):
            low = main.evaluate("() => document.querySelector('.option:last-of-type').getBoundingClientRect().bottom")
            foot = main.evaluate("() => document.querySelector('#lesson .foot').getBoundingClientRect().top")
            assert low <= foot, size
            calm(main)
            assert findings(main) == [], size


@pytest.mark.long
def test_a_class_looks_on(school, browser):
    with open_page(browser, f"{school.door}?watch") as page:
        expect(page.locator("#lesson-title")).to_have_text("A packet moves")
        expect(page.locator("#lesson-class a")).to_be_visible()
        page.keyboard.press("k")
        page.keyboard.press("Space")
        page.wait_for_timeout(300)
        assert not school.state()["running"]


def refused(url: str, body: bytes | None = None, **headers: str) -> int:
    request = urllib.request.Request(url, body, {"Content-Type": "application/json", **headers})
    with pytest.raises(urllib.error.HTTPError) as error:
        urllib.request.urlopen(request, timeout=PATIENCE_S)
    assert "reason" in error.value.read().decode()
    return error.value.code


@pytest.mark.long
def test_the_network_reaches_votes_and_nothing_else(school):
    before = school.state()
    own = {"Origin": school.door.removesuffix("/")}
    assert refused(f"{school.door}api/commands", b'{"type": "resume"}', **own) == 403
    assert refused(f"{school.door}api/brain", **own) == 403
    assert refused(f"{school.door}healthz", Host=f"127.0.0.1:{school.port}") == 403
    assert refused(f"{school.door}api/state", Host=f"127.0.0.1:{school.port}") == 403
    assert refused(f"{school.door}api/vote", b"{}", Origin="http://evil.example") == 403
    assert school.state() == before
    if school.address != "127.0.0.1":
        with pytest.raises(OSError), socket.create_connection((school.address, school.port), timeout=PATIENCE_S):
            pass

"""A recording on the page, in a real Chromium: what it lacks is not there, its end is told, another one can be dropped."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import pytest
from playwright.sync_api import Page, expect

from sim2d import load_world
from tests.e2e.browser import open_page
from tests.e2e.program import Program
from tests.e2e.test_world_editor import drop

FRAMES = 60


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the camera of a simulated robot sees, as a film."""
    from app.session import Session

    session, path = Session(load_world("office"), 1), tmp_path_factory.mktemp("film") / "walk.avi"
    height, width, _ = session.frame.image.shape
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (2 * width, 2 * height))
    for _ in range(FRAMES):
        session.tick()
        picture = cv2.resize(session.frame.image, (2 * width, 2 * height), interpolation=cv2.INTER_NEAREST)
        writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    writer.release()
    return path


@pytest.fixture(scope="module")
def playing(film: Path) -> Iterator[Program]:
    made = Program("--port", "0", "--recording", str(film), "--speed", "0")
    yield made
    assert made.stop() == 0


def tabs(page: Page) -> list[str]:
    return page.get_by_role("tab").all_inner_texts()


def status_is(page: Page, words: str) -> None:
    expect(page.locator("#status span")).to_have_text(words)


def test_it_plays_to_its_end_and_what_it_lacks_is_not_there(playing: Program, browser, film: Path) -> None:
    with open_page(browser, playing.url, stage=False, refused=True) as page:
        status_is(page, "the recording has ended")
        assert page.locator("#world option:checked").inner_text() == film.name
        for lacking in ("#explore", "#kidnap", "#edit", "#pad", "#stage-step", "[data-view=office]"):
            expect(page.locator(lacking)).to_be_hidden()
        expect(page.locator("#tab-truth")).to_be_hidden()
        assert tabs(page) == ["Senses", "Memory", "Inspect", "Tick", "Tune"]
        expect(page.locator("#panel-senses .number")).to_contain_text("#")
        page.keyboard.press("e")
        expect(page.locator(".toast").first).to_contain_text("its robot goes where it went")
        page.keyboard.press(" ")
        expect(page.locator(".toast").filter(has_text="restart it")).to_be_visible()


def test_it_begins_again_and_the_office_comes_back(playing: Program, browser) -> None:
    with open_page(browser, playing.url, stage=False) as page:
        page.click("#restart summary")
        expect(page.locator("#restart-same")).to_contain_text("Play from the beginning with seed 1")
        page.click("#restart-same")
        page.select_option("#world", "loop")
        expect(page.locator("#explore")).to_be_visible()
        assert "Truth" in tabs(page)
        expect(page.locator("[data-view=office]")).to_have_text("Office")


def test_one_is_dropped_and_a_wrong_one_changes_nothing(playing: Program, browser, film: Path) -> None:
    with open_page(browser, playing.url, stage=False, refused=True) as page:
        page.select_option("#world", "loop")
        expect(page.locator("#explore")).to_be_visible()
        drop(page, ("broken.mcap", b"no recording"))
        expect(page.locator("#open-wrong")).to_contain_text("The robot goes on as before.")
        expect(page.locator("#explore")).to_be_visible()
        page.keyboard.press("Escape")
        drop(page, (film.name, film.read_bytes()))
        status_is(page, "the recording has ended")
        expect(page.locator("#explore")).to_be_hidden()
        assert page.locator("#world option:checked").inner_text() == film.name

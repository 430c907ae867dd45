"""The brain that an earlier program kept is quietly offered on the page; one answer counts for all pages."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from app.run_record.folder import STATE
from app.session import Session
from sim2d import load_world
from tests.e2e.browser import calm, open_page, told, until
from tests.e2e.layout import findings
from tests.e2e.program import Program
from tests.unit.app.run_record.kept import keep_ticks

OFFERED = "() => document.getElementById('kept').checkVisibility()"
GONE = "() => !document.getElementById('kept').checkVisibility()"
ASKED = "() => performance.getEntriesByType('resource').some((one) => one.name.endsWith('/api/brain/kept'))"

WITHIN = """() => { const box = document.getElementById('kept').getBoundingClientRect(),
    stage = document.getElementById('stage').getBoundingClientRect();
    return box.left >= 0 && box.right <= innerWidth && box.top >= stage.bottom && box.bottom <= innerHeight; }"""


@pytest.fixture(scope="module")
def left(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Session]:
    """A folder of runs with one that has ended, and its session."""
    folder, session = tmp_path_factory.mktemp("kept") / "runs", Session(load_world("loop"), 7)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RATSLAM_RUNS", str(folder))
        keep_ticks(session, 650)
    return folder, session


@pytest.fixture
def known(left: tuple[Path, Session]) -> Session:
    return left[1]


@pytest.fixture
def offering(left: tuple[Path, Session], tmp_path: Path) -> Iterator[Program]:
    shutil.copytree(left[0], tmp_path / "runs")
    program = Program("--port", "0", "--paused", RATSLAM_RUNS=str(tmp_path / "runs"))
    yield program
    assert program.stop() == 0


def test_the_offer_is_seen_and_taken(offering: Program, browser: Browser, known: Session) -> None:
    count = len(known.brain.experience_map)
    assert offering.state()["world"] == "office"
    with (
        open_page(browser, offering.url, stage=False) as page,
        open_page(browser, offering.url, 390, 844, light=True, stage=False) as phone,
    ):
        for one in (page, phone):
            until(one, OFFERED)
            assert f", 1 simulated minutes, {count} experiences, kept " in one.inner_text("#kept-words")
            assert findings(one, "#kept") == []
            assert one.evaluate(WITHIN)
        page.focus("#kept-wake")
        page.keyboard.press("Enter")
        told(page, f"with {count} experiences.")
        until(page, GONE)
        state = offering.state()
        assert (state["world"], state["seed"], state["tick"]) == ("loop", 7, 0)
        assert state["experiences"] >= count > 100
        phone.evaluate(
            "() => document.dispatchEvent(new Event('visibilitychange'))"
        )  # as if it had been in the background
        until(phone, GONE)


@pytest.mark.long
def test_a_broken_one_is_told_of_and_not_now_stays_gone(offering: Program, browser: Browser, tmp_path: Path) -> None:
    (state,) = tmp_path.glob(f"runs/*/{STATE}")
    state.write_bytes(b"PK")
    with open_page(browser, offering.url, refused=True, stage=False) as page:
        until(page, OFFERED)
        page.click("#kept-wake")
        told(page, "This brain cannot be woken up: ")
        page.keyboard.press("Escape")  # what is wrong is told first
        until(page, OFFERED)
        page.focus("#kept-wake")
        page.keyboard.press("Tab")
        page.keyboard.press("Space")
        until(page, GONE)
        page.reload()
        page.wait_for_selector("body[data-alive]")
        until(page, ASKED)
        calm(page)
        assert page.evaluate(GONE)
    state = offering.state()
    assert (state["world"], state["running"]) == ("office", False)

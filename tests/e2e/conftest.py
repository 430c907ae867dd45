from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.e2e.browser import launch
from tests.e2e.fake_engine import FakeEngine, fake_program
from tests.e2e.program import Program


@pytest.fixture(scope="package")  # its event loop must not outlive these tests
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = launch(playwright)
        yield chromium
        chromium.close()


@pytest.fixture(scope="package")
def worlds_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("own")


@pytest.fixture(scope="module")
def own(worlds_folder: Path) -> Iterator[Path]:
    """The folder of the worlds that are saved, empty at first."""
    yield worlds_folder
    for left in worlds_folder.iterdir():
        left.unlink()


@pytest.fixture(scope="package")
def one_program(worlds_folder: Path) -> Iterator[Program]:
    made = Program("--port", "0", "--seed", "5", "--paused", RATSLAM_WORLDS=str(worlds_folder))
    made.begun = made.post("situation", {})["state_hash"]
    yield made
    assert made.stop() == 0


@pytest.fixture(scope="module")
def program(one_program: Program) -> Program:
    """The one program of these tests, as if it had just been started: paused in the office, which nobody has edited."""
    one_program.command("reset", world="loop")
    one_program.command("reset", world="office", seed=5)
    one_program.command("set_speed", factor=1)
    one_program.command("pause")
    assert one_program.post("situation", {})["state_hash"] == one_program.begun, "the tests before left a parameter"
    return one_program


@pytest.fixture(scope="module")
def fake() -> Iterator[tuple[FakeEngine, str]]:
    """The real page on made-up snapshots: the engine, and the page's address."""
    with fake_program() as made:
        yield made

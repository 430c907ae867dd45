"""A recording on the page, in a real Chromium: what it lacks is not there, its end is told, another one can be dropped."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import pytest
from playwright.sync_api import Page, expect

from sim2d import load_world
from tests.e2e.browser import box_of, open_page, told, until
from tests.e2e.editor import drop
from tests.e2e.program import Program

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


@pytest.mark.long
def test_it_plays_to_its_end_and_what_it_lacks_is_not_there(playing: Program, browser, film: Path) -> None:
    with open_page(browser, playing.url, stage=False, refused=True) as page:
        status_is(page, "the recording has ended")
        assert page.locator("#world option:checked").inner_text() == film.name
        for lacking in ("#explore", "#kidnap", "#edit", "#pad", "[data-view=office]"):
            expect(page.locator(lacking)).to_be_hidden()
        expect(page.locator("#tab-truth")).to_be_hidden()
        assert tabs(page) == ["Senses", "Memory", "Inspect", "Tick", "Tune"]
        expect(page.locator("#panel-senses .number")).to_contain_text("#")
        page.keyboard.press("e")
        expect(page.locator(".toast").first).to_contain_text("its robot goes where it went")
        page.keyboard.press(" ")
        expect(page.locator(".toast").filter(has_text="restart it")).to_be_visible()


@pytest.mark.long
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


# ------------------------------------------------------------ going back


@pytest.mark.long
def test_the_timeline_is_dragged_back_and_a_branch_goes_on_from_there(playing: Program, browser, film: Path) -> None:
    with open_page(browser, playing.url, 1280, 800, stage=False) as page:
        page.select_option("#world", "loop")  # or the end would be that of the test before
        expect(page.locator("#explore")).to_be_visible()
        drop(page, (film.name, film.read_bytes()))
        status_is(page, "the recording has ended")
        before = playing.state()
        assert before["tick"] == FRAMES - 1
        box = box_of(page.locator("#timeline"))
        y, xs = box["y"] + box["height"] / 2, [box["x"] + 6 + (box["width"] - 12) * at_s / 60 for at_s in (5.5, 3.0)]
        page.mouse.move(xs[0], y)
        page.mouse.down()
        page.mouse.move(xs[1], y, steps=5)
        page.mouse.up()
        expect(page.locator("#past")).to_be_visible()
        playing.wait(lambda state: abs(state["time_s"] - 3.0) < 0.2)  # the last moment that the page has asked for
        playing.command("seek", tick=20)
        playing.wait(lambda state: state["tick"] == 20)
        until(page, "() => document.querySelector('#timeline').ariaValueText.startsWith('0:02.0 ')")
        page.keyboard.press("b")
        playing.wait(lambda state: state["tick"] == 19)
        page.keyboard.press(",")
        page.get_by_role("tab", name="Tick").click()
        expect(page.locator("#panel-tick")).to_contain_text("The recording tells of")
        playing.wait(lambda state: state["tick"] == 20)
        page.keyboard.press("n")
        expect(page.locator("#past")).to_be_hidden()
        assert playing.state()["robot"] == before["robot"]
        playing.command("seek", tick=20)
        page.click("#go-on")
        expect(page.locator("#branches [aria-pressed=true]")).to_have_text("2")
        playing.command("set_parameter", name="pose_cells.inhibit", value=0.003)
        page.keyboard.press(" ")
        status_is(page, "the recording has ended")
        assert playing.state()["tick"] == FRAMES - 1
        page.get_by_role("button", name="Branches side by side").click()
        expect(page.locator("#compare-words")).to_contain_text("first difference at tick 21")
        expect(page.locator(".branch-side")).to_have_count(2)


# ------------------------------------------------------------ folders


@pytest.fixture(scope="module")
def folder(film: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The film's first pictures in a folder, with the CSV of a gyro."""
    made, video = tmp_path_factory.mktemp("folder") / "walk round", cv2.VideoCapture(str(film))
    (made / "images").mkdir(parents=True)
    rows = ["image,time_s,yaw_rate"]
    for k in range(30):
        _, picture = video.read()
        cv2.imwrite(str(made / "images" / f"{k}.png"), picture)
        rows.append(f"images/{k}.png,{k / 10},0.0")
    (made / "walk.csv").write_text("\n".join(rows))
    return made


@pytest.mark.long
def test_a_folder_is_dropped_and_plays(playing: Program, browser, folder: Path) -> None:
    with open_page(browser, playing.url, stage=False) as page:
        page.select_option("#world", "loop")
        expect(page.locator("#explore")).to_be_visible()
        mouse = page.context.new_cdp_session(page)
        for step in ("dragEnter", "dragOver", "drop"):
            data = {"items": [], "files": [str(folder)], "dragOperationsMask": 1}
            mouse.send("Input.dispatchDragEvent", {"type": step, "x": 400, "y": 300, "data": data})
        expect(page.locator("#explore")).to_be_hidden()
        told(page, "walk round plays.")
        status_is(page, "the recording has ended")
        assert page.locator("#world option:checked").inner_text() == "walk round"
        assert playing.state()["tick"] == 29


@pytest.mark.long
def test_a_folder_is_chosen_and_what_is_wrong_with_one_is_said(
    playing: Program, browser, folder: Path, tmp_path: Path
) -> None:
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "read me.txt").write_text("nothing to play")
    with open_page(browser, playing.url, stage=False, refused=True) as page:
        page.select_option("#world", "loop")
        expect(page.locator("#explore")).to_be_visible()
        page.locator("#open-folder-files").set_input_files(str(tmp_path / "notes"))
        expect(page.locator("#open-wrong")).to_contain_text("nothing in this folder can be played")
        expect(page.locator("#open-wrong")).to_contain_text("The robot goes on as before.")
        page.locator("#open-folder-files").set_input_files(str(folder))
        expect(page.locator("#explore")).to_be_hidden()
        told(page, "walk round plays.")

"""Files and folders that are dropped into a real Chromium; a link and a file that it gives away. Other ways: tests/page."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from app.session import Session
from sim2d import load_world
from tests.e2e.browser import open_page, told, until
from tests.e2e.editor import drop, edit, plan_png
from tests.e2e.program import Program

pytestmark = pytest.mark.long

SIZE = "(words) => document.getElementById('scale-size').textContent.includes(words)"


def test_dropped_pictures_become_worlds(program: Program, browser: Browser) -> None:
    with open_page(browser, program.url) as page:
        drop(page, ("plan.pgm", cv2.imencode(".pgm", np.zeros((7, 8), np.uint8))[1].tobytes()))
        until(page, SIZE, argument="8 × 7 pixels")
        drop(page, ("plan.png", plan_png()), inside=True)
        until(page, SIZE, argument="90 × 70 pixels")
        page.fill("#scale", "0.1")
        page.click("#open-scale .go")
        told(page, "walls, 8.0 × 6.0 m")
        assert program.wait(lambda state: state["world"] == "plan")["tick"] == 0
        edit(page)
        yaml = (
            b"image: p.png\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
        drop(page, ("m.yaml", yaml), ("p.png", plan_png()))
        told(page, "walls, 16.0 × 12.0 m")


def test_a_folder_is_dropped_or_chosen_and_what_is_wrong_with_one_is_said(
    program: Program, browser: Browser, tmp_path: Path
) -> None:
    """What the camera of a simulated robot sees, as pictures, with the CSV of a gyro."""
    session, folder, notes = Session(load_world("office"), 1), tmp_path / "walk round", tmp_path / "notes"
    for made in folder / "images", notes:
        made.mkdir(parents=True)
    for k in range(30):
        session.tick()
        cv2.imwrite(str(folder / "images" / f"{k}.png"), cv2.resize(session.frame.image, None, fx=2, fy=2))
    rows = [f"images/{k}.png,{k / 10},0.0" for k in range(30)]
    (folder / "walk.csv").write_text("\n".join(["image,time_s,yaw_rate", *rows]))
    (notes / "read me.txt").write_text("nothing to play")
    with open_page(browser, program.url, stage=False, refused=True) as page:
        explore = page.locator("#explore")
        page.locator("#open-folder-files").set_input_files(str(notes))
        expect(page.locator("#open-wrong")).to_contain_text("nothing in this folder can be played")
        page.keyboard.press("Escape")
        expect(explore).to_be_visible()
        for way in "dropped", "chosen":
            if way == "chosen":
                page.locator("#open-folder-files").set_input_files(str(folder))
            else:
                mouse = page.context.new_cdp_session(page)
                data = {"items": [], "files": [str(folder)], "dragOperationsMask": 1}
                for step in ("dragEnter", "dragOver", "drop"):
                    mouse.send("Input.dispatchDragEvent", {"type": step, "x": 400, "y": 300, "data": data})
            told(page, "walk round plays.")
            for lacking in ("#explore", "#kidnap", "#edit", "#pad", "[data-view=office]", "#tab-truth"):
                expect(page.locator(lacking)).to_be_hidden()
            assert page.locator("#world option:checked").inner_text() == "walk round"
            expect(page.locator("#status span")).to_have_text("the recording has ended")
            assert program.state()["tick"] == 29
            page.select_option("#world", "loop")
            expect(explore).to_be_visible()
            page.evaluate("() => toasted.clear()")


def test_a_moment_is_copied_as_a_link_and_saved_as_a_file(program: Program, browser: Browser) -> None:
    program.command("pause")
    program.command("reset", world="office", seed=5)
    program.command("step", ticks=20)
    with open_page(browser, program.url, stage=False) as page:
        page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        page.click("#keep summary")
        page.get_by_role("button", name="Link to this moment").click()
        expect(page.locator("#share-dialog")).to_be_visible()
        link = page.input_value("#share-link")
        told(page, f"The link: copied, {len(link)} characters.")
        assert page.evaluate("() => navigator.clipboard.readText()") == link
        page.click("#share-close")
        page.click("#keep summary")
        with page.expect_download() as loading:
            page.get_by_role("button", name="Save this situation to a file").click()
        assert loading.value.suggested_filename == "office-seed5-0m02.0s.situation.json"
        assert json.loads(Path(loading.value.path()).read_text())["tick"] == 20

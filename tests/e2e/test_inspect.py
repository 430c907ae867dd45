"""Clicks on the plates that inspect; brains downloaded and uploaded."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import on_screen, open_page, show, told, until
from tests.e2e.program import Program
from tests.e2e.test_dashboard import node_on_stage
from web.messages import Packet
from web.viewer.fits.cell_fit import CellFit
from web.viewer.plates.pose_cell_plate import ORIGIN as CELLS_ORIGIN


@pytest.fixture(scope="module")
def walked(program) -> Program:
    """A minute and a half of exploring, paused."""
    tick = program.state()["tick"]
    program.command("step", ticks=900)
    program.wait(lambda state: state["tick"] >= tick + 900)
    return program


def selected(page: Page, tab: str) -> None:
    expect(page.get_by_role("tab", name=tab, exact=True)).to_have_attribute("aria-selected", "true")


def says(page: Page, words: str | re.Pattern[str]) -> None:
    expect(page.get_by_role("tabpanel").get_by_text(words).first).to_be_visible()


def test_a_click_with_shift_on_the_map_and_a_click_into_the_pose_cells_inspect(walked, browser):
    with open_page(browser, walked.url) as page:
        show(page, "map")
        nodes = np.array(walked.state(full=True)["map"]["xy"])
        page.keyboard.down("Shift")
        page.mouse.click(*on_screen(page, "map", node_on_stage(walked, nodes[40], nodes)))
        page.keyboard.up("Shift")
        selected(page, "Inspect")
        says(page, "Links to other experiences")
        number = page.get_by_label("experience #")
        assert np.hypot(*(nodes[int(number.input_value())] - nodes[40])) < 0.3
        assert walked.state()["goal"] is None  # the click was no goal

        link = page.get_by_role("tabpanel").get_by_text(re.compile(r"^(to|from) #\d+$")).first
        wanted = link.inner_text().split("#")[1]
        link.click()
        expect(number).to_have_value(wanted)

        show(page, "pose")
        state = walked.state()["pose_cells"]
        fit = CellFit(tuple(state["shape"]))
        at = fit.packet(Packet(**state["packets"][0])) + CELLS_ORIGIN
        page.mouse.click(*on_screen(page, "pose", tuple(at.tolist())))
        says(page, "pose cells at")
        says(page, "Views linked here, by strength")
        page.get_by_role("button", name="Inject", exact=True).click()
        until(page, "() => document.getElementById('events').textContent.includes('packet')")
        walked.command("step")
        assert len(walked.state()["pose_cells"]["packets"]) == 2


@pytest.mark.long
def test_a_brain_goes_down_to_a_file_and_comes_up_again(walked, browser, tmp_path: Path):
    walked.command("pause")
    known = walked.state()["experiences"]
    with open_page(browser, walked.url, refused=True, stage=False) as page:
        page.click("#restart summary")
        with page.expect_download() as loading:
            page.click("#brain-save")
        file = tmp_path / loading.value.suggested_filename
        loading.value.save_as(file)
        assert file.name == "brain-office-seed5.npz"
        before = walked.state()

        bad = tmp_path / "cat.npz"
        bad.write_bytes(b"a picture of a cat")
        page.set_input_files("#brain-file", bad)
        told(page, "This file is no brain")
        assert walked.state() == before

        page.set_input_files("#brain-file", file)
        told(page, "Started anew with the brain")
        after = walked.wait(lambda state: state["tick"] == 0)
        assert after["experiences"] >= known

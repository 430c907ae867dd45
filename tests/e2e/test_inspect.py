"""Clicks on the plates that inspect."""

from __future__ import annotations

import re

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import on_screen, open_page, show, until
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

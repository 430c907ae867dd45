"""Files that are dropped into a real Chromium become worlds; the editor's bar."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.e2e.browser import at_each, box_of, open_page, told, until
from tests.e2e.editor import drop, edit, plan_png
from tests.e2e.program import Program


@pytest.fixture
def program(one_program: Program) -> Program:
    one_program.command("reset", world="loop")
    return one_program


@pytest.mark.long
def test_the_editor_s_bar_is_one_row_saved_or_not(program, browser) -> None:
    with open_page(browser, program.url, 1024, 768, stage=False) as page:
        page.click("#edit")
        page.wait_for_selector("#editor .bar")
        for size in at_each(page, [(1024, 768), (1280, 800)]):
            places = []
            for unsaved in ("false", "true"):
                page.evaluate(f"() => {{ document.getElementById('edit-unsaved').hidden = !{unsaved}; }}")
                places.append([box_of(page.locator(part)) for part in ("#edit-undo", "#edit-close", "#editor .bar")])
            for undo, close, bar in places:
                assert undo["y"] < close["y"] + close["height"] / 2 < undo["y"] + undo["height"], size
                assert close["x"] + close["width"] <= bar["x"] + bar["width"], size
            assert places[0][2] == places[1][2], size


@pytest.mark.long
def test_a_dropped_picture_becomes_a_world(program, browser):
    with open_page(browser, program.url, 1280, 800) as page:
        drop(page, ("plan.pgm", cv2.imencode(".pgm", np.zeros((7, 8), np.uint8))[1].tobytes()))
        until(page, "() => document.getElementById('scale-size').textContent.includes('8 × 7 pixels')")
        drop(page, ("plan.png", plan_png()), inside=True)
        until(page, "() => document.getElementById('scale-size').textContent.includes('90 × 70 pixels')")
        page.fill("#scale", "0.1")
        until(page, "() => document.getElementById('scale-size').textContent.includes('9.0 × 7.0 m')")
        page.click("#open-scale .go")
        told(page, "walls, 8.0 × 6.0 m")
        assert program.wait(lambda state: state["world"] == "plan")["tick"] == 0
        assert page.is_hidden("#open-dialog")
        edit(page)
        yaml = (
            b"image: p.png\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )
        drop(page, ("m.yaml", yaml), ("p.png", plan_png()))
        told(page, "walls, 16.0 × 12.0 m")

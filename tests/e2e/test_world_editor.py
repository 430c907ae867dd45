"""The world editor in a real Chromium, once through; the rest of it is in tests/page."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim2d import load_world, world_from_json
from tests.e2e.browser import open_page, until
from tests.e2e.editor import click, edit, says, walls_are, world
from tests.e2e.program import Program


@pytest.fixture
def program(one_program: Program) -> Program:
    """The program in the office that comes with it, whatever was drawn before."""
    one_program.command("reset", world="loop")
    one_program.command("reset", world="office", seed=5)
    return one_program


def test_a_wall_is_drawn_undone_redone_saved_and_downloaded(program, browser, own):
    office = load_world("office")
    count = len(office.walls)
    with open_page(browser, program.url, 1440, 900, refused=True, stage=False) as page:
        edit(page)
        page.click("[data-tool=wall]")
        click(page, (1.02, 6.03), (2.52, 6.03))
        walls_are(page, count + 1)
        drawn = world(page)["walls"][-1]
        assert (drawn["from"], drawn["to"]) == ([1.0, 6.0], [2.5, 6.0])
        assert drawn["panels"]  # looks of its own
        says(page, "Click where it ends")  # the next one begins there
        click(page, (2.5, 7.0))
        walls_are(page, count + 2)
        until(page, "() => document.querySelector('#plan .wall')?.getAttribute('d').split('M').length === 3")
        page.keyboard.press("Escape")
        page.keyboard.press("Control+z")
        walls_are(page, count + 1)
        page.click("#edit-undo")
        walls_are(page, count)
        until(
            page,
            "() => document.querySelector('#plan .wall') === null && document.getElementById('edit-undo').disabled",
        )
        assert world_from_json(json.dumps(world(page)), "page") == office
        page.keyboard.press("Control+Shift+Z")
        page.keyboard.press("Control+y")
        walls_are(page, count + 2)
        until(page, "() => document.getElementById('edit-redo').disabled")

        page.click("#edit-menu summary")
        with page.expect_download() as download:
            page.click("#edit-download")
        assert page.is_hidden("#edit-download")
        assert download.value.suggested_filename == "office.json"
        kept = Path(download.value.path()).read_text("utf-8")
        assert len(world_from_json(kept, "kept").walls) == count + 2

        page.click("#edit-save")
        page.fill("#save-name", "office")
        page.click("#save-form .go")
        until(page, "() => document.getElementById('save-wrong').textContent.includes('choose another name')")
        page.fill("#save-name", "my-office")
        page.fill("#save-title", "Mine")
        page.click("#save-form .go")
        until(page, "() => document.getElementById('edit-name').textContent === 'Mine'")
        assert not page.is_visible("#edit-unsaved")
        assert len(json.loads((own / "my-office.json").read_text("utf-8"))["walls"]) == count + 2
        assert program.state()["world"] == "my-office"
        assert page.eval_on_selector_all("#world option", "all => all.map((o) => o.textContent)")[-1] == "Mine"

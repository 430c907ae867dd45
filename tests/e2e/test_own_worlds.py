"""A person's own worlds in a real Chromium: begun empty or with a dropped file, saved, renamed, deleted and brought back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from playwright.sync_api import Page

from sim2d import load_world, world_from_json, world_to_json
from tests.e2e.browser import at_each, box_of, open_page, told, until
from tests.e2e.editor import drop, edit, plan_png, walls_are, world
from tests.e2e.program import Program


@pytest.fixture(scope="module")
def own(own: Path) -> Path:
    """With two saved worlds."""
    for name, title in (("lab", "My laboratory"), ("school", "A school whose name is long enough for two lines")):
        (own / f"{name}.json").write_text(world_to_json(replace(load_world("office"), name=name, title=title)))
    return own


@pytest.fixture
def program(one_program: Program) -> Program:
    one_program.command("reset", world="loop")
    return one_program


def menu(page: Page, item: str) -> None:
    page.click("#edit-menu summary")
    page.click(item)


def listed(page: Page) -> list[str]:
    return page.eval_on_selector_all("#world option", "all => all.map((o) => o.value)")


def test_an_empty_world_is_begun_drawn_in_and_saved(program, browser, own):
    with open_page(browser, program.url, 1440, 900, refused=True, stage=False) as page:
        page.click("#restart summary")
        page.click("#new-world")
        page.fill("#new-name", "office")
        page.click("#new-form .go")
        until(page, "() => document.getElementById('new-wrong').textContent.includes('choose another name')")
        page.fill("#new-name", "gym")
        page.fill("#new-title", "The gym")
        page.fill("#new-width", "1")
        page.click("#new-form .go")  # the browser itself says what is wrong
        assert page.is_visible("#new-dialog")
        page.fill("#new-width", "12")
        page.fill("#new-depth", "6.5")
        page.click("#new-form .go")
        until(page, "() => document.getElementById('edit-name').textContent === 'The gym'")  # in the editor, to draw
        assert page.is_hidden("#new-dialog")
        assert page.is_visible("#edit-unsaved")
        state = program.state()
        assert (state["world"], state["tick"]) == ("gym", 0)
        now = world(page)
        assert [wall["to"] for wall in now["walls"]] == [[12, 0], [12, 6.5], [0, 6.5], [0, 0]]
        assert (len(now["starts"]), len(now["lamps"])) == (1, 1)
        assert not (own / "gym.json").exists()

        page.keyboard.press("w")
        page.keyboard.press("Enter")
        page.keyboard.press("Shift+ArrowUp")
        page.keyboard.press("Enter")
        walls_are(page, 5)
        page.click("#edit-save")
        page.click("#save-form .go")
        until(page, "() => document.getElementById('edit-unsaved').hidden")
        assert len(world_from_json((own / "gym.json").read_text("utf-8"), "gym").walls) == 5
        menu(page, "#edit-new")
        page.wait_for_selector("#new-dialog[open]")
        assert page.input_value("#new-name") == "my-world"
        assert page.is_hidden("#new-unsaved")
        page.click("#new-close")
        assert page.evaluate("() => document.activeElement.closest('#edit-menu') !== null")


@pytest.mark.long
def test_saving_under_another_name_can_rename(program, browser, own):
    with open_page(browser, program.url, 1440, 900, refused=True, stage=False) as page:
        program.command("edit_world", steps=[{"do": "add", "list": "places", "item": {"name": "p", "x": 0.9, "y": 2}}])
        edit(page)
        page.click("#edit-save")
        assert page.is_hidden("#save-rename-row")  # it comes with the program
        page.fill("#save-name", "second")
        page.fill("#save-title", "Second")
        page.click("#save-form .go")
        until(page, "() => document.getElementById('edit-name').textContent === 'Second'")
        page.click("#edit-save")
        assert page.is_hidden("#save-rename-row")
        page.fill("#save-name", "third")
        page.check("#save-rename")
        assert "“Second”, saved as second, goes" in (page.text_content("#save-rename-row") or "")
        page.click("#save-form .go")
        until(page, "() => [...document.querySelectorAll('#world option')].some((o) => o.value === 'third')")
        until(page, "() => ![...document.querySelectorAll('#world option')].some((o) => o.value === 'second')")
        assert not (own / "second.json").exists()
        assert (own / "third.json").exists()
        page.click("#edit-undo")  # an older office, under its present name
        places = "((await (await fetch('/api/world')).json()).world.places ?? [])"
        until(page, f"async () => !{places}.some((place) => place.name === 'p')")
        assert program.state()["world"] == "third"


@pytest.mark.long
def test_a_saved_world_is_opened_deleted_and_brought_back(program, browser, own):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        edit(page)
        menu(page, "#edit-open")
        page.click("#own-list [aria-label='Open My laboratory']")
        assert program.wait(lambda state: state["world"] == "lab")["tick"] == 0
        until(page, "() => document.getElementById('edit-name').textContent === 'My laboratory'")

        menu(page, "#edit-open")
        lab = page.locator("#own-list li", has_text="My laboratory")
        assert "open now" in (lab.text_content() or "")
        lab.locator("[aria-label='Delete My laboratory']").click()
        assert page.is_visible("#delete-open")
        page.click("#delete-dialog [value=keep]")
        assert (own / "lab.json").exists()
        lab.locator("[aria-label='Delete My laboratory']").click()
        page.click("#delete-dialog [value=delete]")
        until(page, "() => document.activeElement.getAttribute('aria-label') === 'Bring My laboratory back'")
        assert not (own / "lab.json").exists()
        until(page, "() => !document.getElementById('edit-unsaved').hidden")  # it goes on, but is in no file
        assert program.state()["world"] == "lab"
        page.keyboard.press("Enter")
        until(page, "() => document.getElementById('edit-unsaved').hidden")
        assert (own / "lab.json").exists()

        page.click("#own-list [aria-label='Delete My laboratory']")
        page.click("#delete-dialog [value=delete]")
        until(page, "() => !document.getElementById('edit-unsaved').hidden")
        page.click("#open-close")
        page.select_option("#world", "loop")
        page.click("#leave-dialog [value=leave]")
        program.wait(lambda state: state["world"] == "loop")
        until(page, "() => ![...document.querySelectorAll('#world option')].some((o) => o.value === 'lab')")
        assert "school" in listed(page)


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


@pytest.mark.long
def test_what_cannot_be_opened_says_why_and_the_session_goes_on(program, browser):
    program.command("step", ticks=7)
    before = program.state()
    with open_page(browser, program.url, 1280, 800, refused=True, stage=False) as page:
        for files, why in (
            ([("w.json", b'{"format": 1,\n "name": }')], "w.json: not JSON: line 2, column 10"),
            ([("m.yaml", b"image: p.png\nresolution: zero\n")], "m.yaml: origin is missing"),
            ([("a.txt", b"hello")], "a.txt: cannot be imported"),
            ([("v.json", b"[[0, 0, 1, 0], [1, 0, 1]]")], "v.json: [1]: got [1, 0, 1]; must be"),
            ([("a.json", b"[]"), ("b.json", b"[]")], "one plan at a time"),
        ):
            drop(page, *files)
            until(page, "(why) => document.getElementById('open-wrong').textContent.includes(why)", argument=why)
            assert "The robot goes on as before." in (page.text_content("#open-wrong") or "")
        drop(page, ("black.png", cv2.imencode(".png", np.zeros((20, 20), np.uint8))[1].tobytes()))
        page.click("#open-scale .go")
        until(page, "() => document.getElementById('open-wrong').textContent.includes('no pixel is floor')")
    assert program.state() == before

"""The world editor in a real Chromium."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim2d import load_world, world_from_json
from tests.e2e.browser import open_page, until
from tests.e2e.editor import click, drag, edit, says, walls_are, world
from tests.e2e.program import Program

# Where a person's head is drawn, and whose it is, at one moment, since the plan is drawn anew ten times a second.
HEAD = """(k) => { const head = document.querySelectorAll("#plan .head")[k], box = head.getBoundingClientRect();
    return [head.querySelector("title").textContent, box.left + box.width / 2, box.top + box.height / 2]; }"""


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


@pytest.mark.long
def test_things_of_every_kind_are_drawn_moved_and_deleted(program, browser):
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        edit(page)
        for tool, points, finish in (
            ("door", [(8.0, 1.0), (9.0, 1.0)], False),
            ("lamp", [(5.0, 5.0)], False),
            ("box", [(0.5, 3.0), (1.0, 3.5)], False),
            ("person", [(1.0, 4.5), (4.0, 4.5)], True),
            ("zone", [(6.0, 6.0), (8.0, 6.0), (8.0, 7.0)], True),
            ("start", [(9.0, 4.0), (9.0, 5.0)], False),
            ("place", [(0.5, 5.0)], False),
        ):
            page.click(f"[data-tool={tool}]")
            click(page, *points)
            if finish:
                page.click("#edit-finish")
            until(page, "() => !document.getElementById('fields').hidden")
        now = world(page)
        assert now["doors"][0]["hinge"] == [8.0, 1.0]
        assert (now["doors"][0]["width"], now["doors"][0]["angle_deg"]) == (1.0, 0.0)
        assert now["people"][0]["path"] == [[1.0, 4.5], [4.0, 4.5]]
        assert now["slow_zones"][0]["corners"] == [[6.0, 6.0], [8.0, 6.0], [8.0, 7.0]]
        assert now["starts"][-1]["heading_deg"] == 90.0
        box = now["boxes"][0]
        assert (box["x"], box["y"], box["width"], box["depth"]) == (0.75, 3.25, 0.5, 0.5)

        page.click("[data-tool=select]")
        drag(page, (0.75, 3.25), (0.75, 2.25))
        until(page, "async () => (await (await fetch('/api/world')).json()).world.boxes[0].y === 2.25")
        page.fill("#fields [data-key=width]", "0.8")
        page.press("#fields [data-key=width]", "Enter")
        until(page, "async () => (await (await fetch('/api/world')).json()).world.boxes[0].width === 0.8")
        page.keyboard.press("Tab")
        page.focus("#plan")
        page.keyboard.press("Delete")
        until(page, "async () => (await (await fetch('/api/world')).json()).world.boxes === undefined")
        page.click("[data-tool=delete]")
        click(page, (5.0, 5.0))
        until(page, "async () => (await (await fetch('/api/world')).json()).world.lamps === undefined")


@pytest.mark.long
def test_a_door_makes_its_own_gap_and_corners_stay_closed(program, browser):
    count = len(load_world("office").walls)
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        edit(page)
        page.click("[data-tool=wall]")
        drag(page, (1.0, 4.5), (4.0, 4.5))
        walls_are(page, count + 1)
        page.click("[data-tool=door]")
        click(page, (2.0, 4.5), (3.0, 4.5))
        walls_are(page, count + 2)
        assert [(w["from"], w["to"]) for w in world(page)["walls"][-2:]] == [
            ([1.0, 4.5], [2.0, 4.5]),
            ([3.0, 4.5], [4.0, 4.5]),
        ]
        page.keyboard.press("Control+z")  # one step: door and gap
        walls_are(page, count + 1)
        page.click("[data-tool=select]")
        click(page, (10.0, 7.5))  # the outer wall on the right, to show its grips
        drag(page, (10.0, 8.0), (10.5, 8.0))
        until(page, "async () => (await (await fetch('/api/world')).json()).world.walls[1].to[0] === 10.5")
        outer = [w for w in world(page)["walls"] if w.get("outer")]
        assert all(a["to"] == b["from"] for a, b in zip(outer, [*outer[1:], outer[0]], strict=True))


def test_a_wall_onto_the_robot_is_refused_and_nothing_changes(program, browser):
    program.command("kidnap", x=5.0, y=4.0, heading_rad=0.0)
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        edit(page)
        before, hands = world(page), program.state()
        page.click("[data-tool=wall]")
        click(page, (4.5, 4.0), (5.5, 4.0))
        says(page, "The wall would cover the robot at (5.00, 4.00)")
        assert page.get_attribute("#plan-status", "class") == "bad"
        assert world(page) == before
        assert program.state()["robot"] == hands["robot"]
        assert page.locator("#plan .dot").count() == 0
        page.click("[data-tool=door]")
        click(page, (1.0, 1.0), (1.25, 1.0))
        says(page, "A door is 0.3 to 6 m wide; this one would be 0.25 m.")


@pytest.mark.long
def test_the_keyboard_alone_draws_a_wall(program, browser):
    count = len(load_world("office").walls)
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        page.keyboard.press("o")
        until(page, "() => document.querySelector('#plan .outer') !== null")
        page.keyboard.press("w")
        page.keyboard.press("Enter")
        for key in ("ArrowRight", "ArrowRight", "Shift+ArrowUp"):
            page.keyboard.press(key)
        says(page, " m. Click where it ends")
        page.keyboard.press("Enter")
        walls_are(page, count + 1)
        wall = world(page)["walls"][-1]
        assert [round(b - a, 6) for a, b in zip(wall["from"], wall["to"], strict=True)] == [0.5, 1.25]
        page.keyboard.press("Escape")
        page.keyboard.press("v")
        page.keyboard.press("Escape")
        assert page.is_hidden("#editor")
        assert page.evaluate("() => document.activeElement.id") == "edit"


@pytest.mark.long
def test_edits_of_two_pages_meet(program, browser):
    with open_page(browser, program.url, 1280, 800, stage=False) as page:
        edit(page)
        step = {"do": "add", "list": "places", "item": {"name": "somewhere", "x": 5.0, "y": 5.0}}
        program.command("edit_world", steps=[step])
        until(page, "() => [...document.querySelectorAll('#plan .name')].some((t) => t.textContent === 'somewhere')")


@pytest.mark.long
def test_people_boxes_and_lamps_are_drawn_as_they_are_now(program, browser):
    program.command("reset", world="living")
    people = program.state()["living"]["people"]
    where = "() => [...document.querySelectorAll('#plan .head')].map((c) => [c.cx.baseVal.value, c.cy.baseVal.value])"
    with open_page(browser, program.url, 1440, 900, stage=False) as page:
        edit(page)
        until(page, "(n) => document.querySelectorAll('#plan .head').length === n", argument=people)
        assert page.locator("#plan .box.away").count() == 1  # the trolley, which comes at 5:00
        before, still = page.evaluate(where), page.locator("#plan .body").get_attribute("cx")
        program.command("step", ticks=30)
        until(page, "(was) => document.querySelector('#plan .body').getAttribute('cx') !== was", argument=still)
        who_moved = (
            f"(was) => ({where})().findIndex(([x, y], k) => Math.abs(x - was[k][0]) + Math.abs(y - was[k][1]) > 10)"
        )
        until(page, f"(was) => ({who_moved})(was) >= 0", argument=before)  # the last of the steps are drawn later
        name, *middle = page.evaluate(HEAD, page.evaluate(who_moved, before))
        page.mouse.click(*middle)
        until(page, "() => document.querySelector('#fields h2').textContent === 'Person'")
        assert page.input_value("#fields [data-key=name]") == name

        program.command("set_lamp", name="hall east", on=False)
        until(page, "() => document.querySelector('#plan .bulb.off title')?.textContent === 'hall east, off'")
        program.command("set_parameter", name="office.people", value=False)
        program.command("step", ticks=1)
        until(page, "() => document.querySelectorAll('#plan .head').length === 0")
        program.command("set_parameter", name="office.people", value=True)


@pytest.mark.long
def test_leaving_an_edited_office_asks_first(program, browser):
    with open_page(browser, program.url, 1280, 800, stage=False) as page:
        edit(page)
        page.click("[data-tool=place]")
        click(page, (5.0, 5.0))
        until(page, "() => !document.getElementById('edit-unsaved').hidden")
        page.select_option("#world", "loop")
        page.click("#leave-dialog [value=stay]")
        page.wait_for_timeout(300)
        assert program.state()["world"] == "office"
        page.select_option("#world", "loop")
        page.click("#leave-dialog [value=leave]")
        assert program.wait(lambda state: state["world"] == "loop")["tick"] == 0

"""A world of more walls than SVG can carry, in the real program and a real browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

from benchmarks.office import rooms
from sim2d import world_to_json

from .browser import open_page, until
from .program import Program

INK = """() => {
    const canvas = document.querySelector("canvas.painted");
    if (!canvas || canvas.hidden || !canvas.width) return 0;
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    return pixels.filter((value, k) => k % 4 === 3 && value > 0).length;
}"""
WALLS = 1500


@pytest.fixture
def large(tmp_path: Path):
    file = tmp_path / "large.json"
    file.write_text(world_to_json(rooms(WALLS, 10)), encoding="utf-8")
    program = Program("--port", "0", "--seed", "1", "--world", str(file))
    yield program
    assert program.stop() == 0


def test_thousands_of_walls_are_drawn_and_edited_while_it_runs(large: Program, browser: Browser) -> None:
    with open_page(browser, large.url, 1440, 900) as page:
        page.click("#edit")
        until(page, "() => document.querySelector('#plan .body') !== null")
        until(page, f"() => ({INK})() > 10000")
        assert page.locator("#plan .walls path").count() == 0
        all_of_it = page.evaluate(INK)
        page.evaluate("() => document.documentElement.dataset.theme = 'light'")
        until(page, f"() => Math.abs(({INK})() - {all_of_it}) < {all_of_it // 20}")
        robot = large.state()["robot"]
        item = {"from": [robot["x"] + 0.6, robot["y"]], "to": [robot["x"] + 0.6, robot["y"] + 1.0]}
        large.command("edit_world", steps=[{"do": "add", "list": "walls", "item": item}])
        until(page, "() => document.getElementById('edit-undo').title.startsWith('Undo: wall drawn')")
        for _ in range(12):
            page.click("#edit-closer")
        until(page, f"() => ({INK})() < {all_of_it // 2}")  # what is out of sight is not painted
        tick = large.state()["tick"]
        large.wait(lambda state: state["tick"] > tick + 10)

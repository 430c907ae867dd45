"""What a person does in the world editor: opens it, clicks and drags on its plan, drops files on the page."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np
from playwright.sync_api import Page

from tests.e2e.browser import until

DROP = """async ([files, inside]) => {
  const data = new DataTransfer();
  for (const [name, text] of files) data.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
  const frame = document.getElementById("stage");
  const [place, Event] = inside ? [frame.contentDocument.body, frame.contentWindow.DragEvent] : [document.body, DragEvent];
  place.dispatchEvent(new Event("dragenter", { dataTransfer: data, bubbles: true, cancelable: true }));
  const sheet = document.getElementById("drop");
  const shown = !sheet.hidden;
  sheet.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
  return shown;
}"""


def world(page: Page) -> dict[str, Any]:
    return page.evaluate("async () => (await (await fetch('/api/world')).json()).world")


def walls_are(page: Page, count: int) -> None:
    until(page, "async (n) => (await (await fetch('/api/world')).json()).world.walls.length === n", argument=count)


def edit(page: Page) -> None:
    page.click("#edit")
    until(
        page, "() => document.querySelector('#plan .outer') !== null && document.querySelector('#plan .body') !== null"
    )


def at(page: Page, x: float, y: float) -> tuple[float, float]:
    """Where a point of the office (10 x 8 m) is on the page, by its drawn outline."""
    box = page.evaluate("""() => { const b = document.querySelector("#plan .outer").getBBox();
        const p = document.getElementById("plan").getBoundingClientRect(); return [p.x + b.x, p.y + b.y, b.width, b.height]; }""")
    return box[0] + box[2] * x / 10, box[1] + box[3] * (1 - y / 8)


def click(page: Page, *points: tuple[float, float]) -> None:
    for point in points:
        page.mouse.click(*at(page, *point))


def says(page: Page, words: str) -> None:
    until(page, "(words) => document.getElementById('plan-status').textContent.includes(words)", argument=words)


def drop(page: Page, *files: tuple[str, bytes], inside: bool = False) -> None:
    given = [[name, base64.b64encode(data).decode()] for name, data in files]
    assert page.evaluate(DROP, [given, inside])


def plan_png() -> bytes:
    picture = np.zeros((70, 90), np.uint8)
    picture[5:65, 5:85] = 255
    picture[5:40, 44:47] = 0
    return cv2.imencode(".png", picture)[1].tobytes()

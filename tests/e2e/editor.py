"""The world editor is opened, files are dropped on the page."""

from __future__ import annotations

import base64

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


def edit(page: Page) -> None:
    page.click("#edit")
    until(
        page, "() => document.querySelector('#plan .outer') !== null && document.querySelector('#plan .body') !== null"
    )


def drop(page: Page, *files: tuple[str, bytes], inside: bool = False) -> None:
    given = [[name, base64.b64encode(data).decode()] for name, data in files]
    assert page.evaluate(DROP, [given, inside])


def plan_png() -> bytes:
    picture = np.zeros((70, 90), np.uint8)
    picture[5:65, 5:85] = 255
    picture[5:40, 44:47] = 0
    return cv2.imencode(".png", picture)[1].tobytes()

"""A real Chromium and what a person sees of the page in it."""

from __future__ import annotations

import contextlib
import math
import shutil
import time
from collections.abc import Iterator

import numpy as np
from playwright.sync_api import Browser, Page, Playwright

from web.stage.camera_views import View, camera_for

ARGUMENTS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
ARGUMENTS += ["--disable-background-networking"]


def launch(playwright: Playwright) -> Browser:
    """Debian's Chromium where there is one, else playwright's own."""
    return playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS)


@contextlib.contextmanager
def open_page(
    browser: Browser,
    url: str,
    width: int = 1280,
    height: int = 800,
    *,
    light: bool = False,
    gone: bool = False,
    refused: bool = False,
) -> Iterator[Page]:
    """The page, awake and alive; afterwards: no error in its console and no request that left its origin.

    `gone`: the server goes away meanwhile, so that connections may be refused. `refused`: the server has a reason to refuse
    an upload, which Chromium notes.
    """
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme="light" if light else "dark", has_touch=width < 500
    )
    page = context.new_page()
    faults: list[str] = []
    page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    own = (url, url.replace("http://", "ws://"), "data:", "blob:")
    page.on("request", lambda request: None if request.url.startswith(own) else faults.append(request.url))
    page.on("websocket", lambda socket: None if socket.url.startswith(own) else faults.append(socket.url))
    try:
        page.goto(url)
        page.wait_for_selector("#stage.awake", timeout=60_000)
        page.wait_for_selector("body[data-alive]", timeout=30_000)
        yield page
        expected = ("ERR_CONNECTION_REFUSED",) * gone + ("status of 422",) * refused
        left = [text for text in faults if not any(words in text for words in expected)]
        assert not left, "\n".join(left)
    finally:
        context.close()


def until(page: Page, condition: str, timeout_s: float = 10.0, argument: object = None) -> None:
    """Wait until a JavaScript function says yes. Playwright's own wait is refused by the page's security policy."""
    deadline = time.monotonic() + timeout_s
    while not page.evaluate(condition, argument):
        assert time.monotonic() < deadline, f"not within {timeout_s} s: {condition}"
        page.wait_for_timeout(30)


def show(page: Page, view: View) -> None:
    """Press a view button and wait until the camera is there, however slowly it is drawn."""
    page.click(f"[data-view={view}]")
    page.wait_for_timeout(3500)


def on_screen(page: Page, view: View, at: tuple[float, float, float]) -> tuple[float, float]:
    """Where a point of the stage is on the page when the camera stands at a view."""
    canvas = page.frame_locator("#stage").locator("canvas").first.bounding_box()
    assert canvas is not None
    camera = camera_for(view, canvas["width"] / canvas["height"])
    forward = camera.look_at - camera.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    ray = np.array(at) - camera.position
    reach = (ray @ forward) * math.tan(camera.fov_rad / 2) / (canvas["height"] / 2)
    x = canvas["x"] + canvas["width"] / 2 + ray @ right / reach
    y = canvas["y"] + canvas["height"] / 2 - ray @ np.cross(right, forward) / reach
    return float(x), float(y)

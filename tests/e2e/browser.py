"""A real Chromium and what a person sees of the page in it."""

from __future__ import annotations

import contextlib
import math
import shutil
import time
import weakref
from collections.abc import Iterable, Iterator
from typing import Any

import msgspec
import numpy as np
from playwright.sync_api import Browser, FloatRect, Locator, Page, Playwright, WebSocket, expect

from tests.patience import PATIENCE_S
from web.viewer.camera_views import Camera, View, camera_for

# As without a graphics card: SwiftShader draws the plates, Chromium the page itself. Were SwiftShader to compose the page as
# well, a page in which something moves would keep most of a core busy.
ARGUMENTS = ["--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader", "--no-sandbox"]
ARGUMENTS += ["--disable-background-networking"]
PATIENCE_MS = 1000 * PATIENCE_S
expect.set_options(timeout=PATIENCE_MS)
# Toasts disappear after some seconds, in which a busy machine may not have looked.
KEEP_TOASTS = """if (window === top) {
    window.toasted = new Set();
    const look = () => document.querySelectorAll(".toast").forEach((toast) => toasted.add(toast.textContent));
    new MutationObserver(look).observe(document, { subtree: true, childList: true, characterData: true });
}"""
NO_STAGE = "<!doctype html><canvas style='position: fixed; inset: 0; width: 100%; height: 100%'></canvas>"
_told_camera: weakref.WeakKeyDictionary[Page, dict[str, Any]] = weakref.WeakKeyDictionary()


def launch(playwright: Playwright) -> Browser:
    """Debian's Chromium if there is one, else playwright's own."""
    return playwright.chromium.launch(executable_path=shutil.which("chromium"), args=ARGUMENTS, timeout=PATIENCE_MS)


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
    forbidden: bool = False,
    stage: bool = True,
    first: bool = False,
    touched: bool = False,
    level: str | None = None,
) -> Iterator[Page]:
    """The page, awake and alive. Afterwards its console must have no error, and no request may have left its origin.

    gone: the server goes away meanwhile, so connections may be refused. refused: the server has a reason to refuse an
    upload, which Chromium logs. forbidden: the same of what only the main page may do. stage: without the viewer the page
    is there in a tenth of the time, to test what is around it. first: as on a first visit, which is welcomed. touched: by
    fingers, as a page narrower than 500 pixels is anyway. level: how much is in sight, by default
    little on a first visit and else everything.
    """
    context = browser.new_context(
        viewport={"width": width, "height": height},
        color_scheme="light" if light else "dark",
        has_touch=touched or width < 500,
    )
    context.set_default_timeout(PATIENCE_MS)
    context.add_init_script(KEEP_TOASTS)
    kept = {"level": level or "watch"} if first else {"level": level or "lab", "first minute": "seen"}
    for key, value in kept.items():  # Chromium's own page of errors keeps nothing
        context.add_init_script(f"if (origin !== 'null') localStorage['{key}'] ??= '{value}'")
    page = context.new_page()
    faults: list[str] = []
    page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    base = url.partition("?")[0]
    own = (base, base.replace("http://", "ws://"), "data:", "blob:")
    page.on("request", lambda request: None if request.url.startswith(own) else faults.append(request.url))
    page.on("websocket", lambda socket: None if socket.url.startswith(own) else faults.append(socket.url))
    page.on("websocket", lambda socket: _hear_camera(page, socket))
    if not stage:
        page.route("**/viser/**", lambda route: route.fulfill(content_type="text/html", body=NO_STAGE))
    try:
        page.goto(url)
        if stage:
            page.wait_for_selector("#stage.awake")
        page.wait_for_selector("body[data-alive]")
        yield page
        expected = ("ERR_CONNECTION_REFUSED",) * gone + ("status of 422",) * refused
        expected += ("status of 403",) * forbidden
        left = [text for text in faults if not any(words in text for words in expected)]
        assert not left, "\n".join(left)
    finally:
        context.close()


def at_each(page: Page, sizes: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """The page at one size after the other. To open it at each would take most of the time of a test of how it looks."""
    for width, height in sizes:
        page.set_viewport_size({"width": width, "height": height})
        draw(page)
        yield width, height


def until(page: Page, condition: str, *, argument: object = None) -> None:
    """Wait until a JavaScript function returns true. Playwright's own wait is refused by the page's security policy."""
    end = time.monotonic() + PATIENCE_S
    while not page.evaluate(condition, argument):
        assert time.monotonic() < end, f"not within {PATIENCE_S:g} s: {condition}"
        page.wait_for_timeout(30)


def told(page: Page, words: str) -> None:
    """Wait until a toast has said this, even if it has disappeared again."""
    until(page, "(words) => [...toasted].some((said) => said.includes(words))", argument=words)


def box_of(locator: Locator) -> FloatRect:
    """Where it rests on the page. While the page draws it anew it is nowhere for a moment, and while a panel opens or closes
    it moves: so ask until two answers, a frame or two apart, are the same."""
    end, before = time.monotonic() + PATIENCE_S, None
    while (box := locator.bounding_box()) is None or box != before:
        assert time.monotonic() < end, f"at rest nowhere on the page within {PATIENCE_S:g} s: {locator}"
        before = box
        locator.page.wait_for_timeout(50)
    return box


def _hear_camera(page: Page, socket: WebSocket) -> None:
    """Keep the newest camera that viser's client has reported."""

    def sent(frame: bytes | str) -> None:
        if isinstance(frame, bytes) and b"ViewerCameraMessage" in frame:
            _told_camera[page] = msgspec.msgpack.decode(frame)

    if "/viser/" in socket.url:
        socket.on("framesent", sent)


def show(page: Page, view: View) -> None:
    """Press a view button, and wait until the camera has arrived and two frames are drawn, however slowly."""
    page.click(f"[data-view={view}]")
    end = time.monotonic() + PATIENCE_S
    while not _stands_at(page, view):
        assert time.monotonic() < end, f"the camera is not at {view} within {PATIENCE_S:g} s: {_told_camera.get(page)}"
        page.wait_for_timeout(50)
    draw(page)
    page.wait_for_timeout(300)


def draw(page: Page) -> None:
    """Wait until two frames are drawn, however slowly."""
    page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")


def camera_of(page: Page) -> Camera:
    """The camera of the page's viewer, as it was last."""
    told = _told_camera[page]
    return Camera(np.array(told["position"]), np.array(told["look_at"]), told["fov"])


def eye_of(page: Page) -> np.ndarray:
    """Where that is."""
    return camera_of(page).position


def _stands_at(page: Page, view: View) -> bool:
    told = _told_camera.get(page)
    if told is None:
        return False
    camera = camera_for(view, told["image_width"] / told["image_height"])  # what the server has to go by
    is_there = np.allclose([*told["position"], *told["look_at"]], [*camera.position, *camera.look_at], atol=0.01)
    return bool(is_there) and abs(told["fov"] - camera.fov_rad) < 1e-4


def calm(page: Page) -> None:
    """Wait until no transition of colour or place is under way; endless animations may go on."""
    until(
        page,
        """() => document.getAnimations().every(
        (moving) => moving.playState !== "running" || moving.effect.getComputedTiming().endTime === Infinity)""",
    )


def turn_theme(page: Page) -> None:
    """Change the theme: dark to light, or light to dark."""
    was = page.get_attribute("html", "data-theme")
    page.evaluate("() => document.getElementById('theme').click()")
    until(page, "(was) => document.documentElement.dataset.theme !== was", argument=was)
    calm(page)


def on_screen(
    page: Page, view: View | Camera, at: tuple[float, float, float], canvas: FloatRect | None = None
) -> tuple[float, float]:
    """Where a point of the scene is on the page when the camera is at a view, or has been turned from there. canvas: where the
    picture is, if not viser's."""
    canvas = canvas or box_of(page.frame_locator("#stage").locator("canvas").first)
    camera = view if isinstance(view, Camera) else camera_for(view, canvas["width"] / canvas["height"])
    forward = camera.look_at - camera.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    ray = np.array(at) - camera.position
    reach = (ray @ forward) * math.tan(camera.fov_rad / 2) / (canvas["height"] / 2)
    x = canvas["x"] + canvas["width"] / 2 + ray @ right / reach
    y = canvas["y"] + canvas["height"] / 2 - ray @ np.cross(right, forward) / reach
    return float(x), float(y)

"""What bends viser's client (viser_client.js) on the real one: each of these fails when viser's inside is another.

Clicks, and a press on what can be dragged, which must log no error, are tested in test_dashboard.py, what a pinch does in
test_touch.py, resting in resting.test.js.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, WebSocket, expect

from tests import patience
from tests.e2e.browser import open_page, told, until
from tests.e2e.program import Program

INSIDE = "const inside = document.getElementById('stage').contentWindow, paper = inside.document;"


@pytest.fixture(scope="module")
def page(program: Program, browser: Browser) -> Iterator[Page]:
    """It has drawn a whole frame, and its console has no error in the end."""
    with open_page(browser, program.url) as opened:
        until(opened, "() => document.getElementById('waiting').hidden")
        yield opened


def test_its_notice_that_there_is_no_graphics_card_gives_way_to_a_sentence(page: Page) -> None:
    told(page, "No graphics card in use")
    expect(page.frame_locator("#stage").locator(".mantine-Notification-title")).to_have_count(0)


def test_its_empty_panel_is_there_and_hidden(page: Page) -> None:
    shown = page.evaluate(f"""() => {{ {INSIDE}
        const theirs = "[data-dock-root] > div:not(:has(> canvas)), .mantine-Paper-root[style*='fixed']";
        return [...paper.querySelectorAll(theirs)].map((part) => part.checkVisibility()); }}""")
    assert shown
    assert not any(shown)


def test_software_draws_three_quarters_of_the_pixels_without_smooth_edges(page: Page) -> None:
    smooth, share = page.evaluate(f"""() => {{ {INSIDE}
        const canvas = [...paper.querySelectorAll("canvas")].find((one) => one.width);
        return [canvas.getContext("webgl2").getContextAttributes().antialias, canvas.width / canvas.clientWidth]; }}""")
    assert not smooth
    assert share == pytest.approx(0.75, abs=0.01)


def test_its_loop_of_frames_is_recognised(page: Page) -> None:
    page.evaluate(f"() => {{ {INSIDE} inside.drew = 0; inside.addEventListener('drawn', () => inside.drew++); }}")
    until(page, f"() => {{ {INSIDE} return inside.drew > 2; }}")


def test_its_camera_can_be_moved_by_two_fingers(page: Page) -> None:
    kinds = page.evaluate(f"""() => {{ {INSIDE}
        const camera = inside.__viserMutable.cameraControl;
        return [camera.dollyTo, camera.truck, camera.distance, camera.camera.fov].map((part) => typeof part); }}""")
    assert kinds == ["function", "function", "number", "number"]


def test_it_connects_again_while_the_focus_is_elsewhere(page: Page) -> None:
    again: list[WebSocket] = []
    page.on("websocket", lambda socket: again.append(socket) if "/viser/ws/" in socket.url else None)
    for theme in ("light", "dark"):  # the viewer of the other theme is another server
        again.clear()
        page.click("#theme")
        assert page.evaluate("() => document.activeElement.id") != "stage"
        until(page, "(theme) => document.documentElement.dataset.theme === theme", argument=theme)
        patience.until(lambda: page.wait_for_timeout(50) or again)

"""Two brains on the stage."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser

from tests.e2e.browser import box_of, eye_of, open_page, show
from tests.e2e.program import Program
from tests.patience import until
from web.viewer.camera_views import camera_for


@pytest.mark.long
def test_the_stage_shows_both_and_then_one_again(program: Program, browser: Browser) -> None:
    program.command("compare_brains", pair="papers")
    program.command("step", ticks=100)
    with open_page(browser, program.url) as page:
        canvas = page.frame_locator("#stage").locator("canvas").first

        def stands(two: bool) -> bool:
            box = box_of(canvas)
            wanted = camera_for("all", box["width"] / box["height"], two=two).position
            page.wait_for_timeout(30)
            return bool(abs(eye_of(page) - wanted).max() < 0.05)

        until(lambda: stands(two=True), "both brains are in view")
        page.get_by_role("button", name="End the comparison").click()
        until(lambda: stands(two=False), "one brain is in view")
        show(page, "map")

"""The page of an experiment, opened from its file as a reader would."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from app.experiments.report import write_report_page
from tests.e2e.layout import findings
from tests.unit.app.made_trials import experiment, figure, trace, trials

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = experiment(
        figures=[
            figure("curves", score="goals reached", along="N_vis", lines="size"),
            figure("dots", score="map error", by="size"),
            figure("maps", show="experience map", each="size"),
        ]
    )
    stored = trials(made)
    traces = {each.id: trace(each, made) for each in stored}
    out = tmp_path_factory.mktemp("page")
    return write_report_page(made, stored, out, lambda ids: [traces[each] for each in ids], command="ratslam").page


@pytest.fixture
def page(browser: Browser, written: Path) -> Iterator[Page]:
    """The page; afterwards its console must have said nothing, and nothing may have been loaded but the file itself."""
    with browser.new_context(viewport={"width": 1100, "height": 900}) as context:
        opened, faults = context.new_page(), list[str]()
        opened.on("console", lambda message: faults.append(message.text))
        opened.on("pageerror", lambda error: faults.append(str(error)))
        own = (written.as_uri(), "data:")
        opened.on("request", lambda asked: None if asked.url.startswith(own) else faults.append(asked.url))
        opened.goto(written.as_uri())
        yield opened
        assert faults == []


def test_a_dot_shows_the_command_that_opens_its_trial_to_be_copied(page: Page) -> None:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    box = page.locator("#box")
    expect(box).to_be_hidden()
    for k, press in enumerate((lambda dot: dot.click(), lambda dot: (dot.focus(), page.keyboard.press("Enter")))):
        dot = page.locator("svg [id^='f2-trial-']").nth(3 + k)
        command = f"ratslam experiment open {dot.get_attribute('data-trial')}"
        press(dot)
        expect(box).to_be_visible()
        expect(box.locator("code")).to_have_text(command)
        for words in ("N_vis 0 %, size 8", "kitchen: reached, at 61.5 s") if k == 0 else ():
            expect(box).to_contain_text(words)
        page.get_by_role("button", name="Copy").click()
        expect(page.get_by_role("button", name="Copied")).to_be_visible()
        assert page.evaluate("navigator.clipboard.readText()") == command
        page.keyboard.press("Escape")
        expect(box).to_be_hidden()
        expect(dot).to_be_focused()


@pytest.mark.long
def test_a_point_of_a_curve_lists_its_trials_and_a_panel_of_a_map_tells_its_own(page: Page) -> None:
    page.locator("svg [data-cell]").first.click()
    expect(page.locator("#box code")).to_have_count(4)
    page.locator("svg [id^='f3-trial-']").first.click(position={"x": 15, "y": 15})
    expect(page.locator("#box code")).to_have_count(1)
    page.locator("h1").click()
    expect(page.locator("#box")).to_be_hidden()


@pytest.mark.long
def test_it_is_accessible_in_both_themes_and_fits_a_small_screen(page: Page) -> None:
    page.locator("svg [data-trial]").first.focus()
    page.keyboard.press("Enter")
    for theme in "light", "dark":
        page.emulate_media(color_scheme=theme)
        assert findings(page) == [], theme
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.locator("svg [data-trial]").last.click()
    corner = page.locator("#box").bounding_box()
    assert corner is not None
    assert corner["x"] >= 0
    assert corner["x"] + corner["width"] <= 390

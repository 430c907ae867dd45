"""Two brains compared on the page: two clicks begin it, the strip tells how they differ, one click ends it."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, expect

from ratslam_core.params.additions import ADDITIONS
from tests.e2e.browser import box_of, eye_of, open_page, show, told
from tests.e2e.program import Program
from tests.patience import until
from web.viewer.camera_views import camera_for


def test_two_clicks_begin_it_and_one_ends_it(program: Program, browser: Browser) -> None:
    program.command("reset", seed=5)
    with open_page(browser, program.url, stage=False) as page:
        expect(page.locator("#beside")).to_be_hidden()
        page.get_by_label("Compare brains").click()
        page.get_by_role("button", name="Without vision Path integration alone").click()
        told(page, "Two brains, the same senses")
        expect(page.get_by_role("button", name="Both")).to_be_visible()
        program.command("step", ticks=300)
        state = program.state()
        first, second = page.locator("#beside-first"), page.locator("#beside-second")
        expect(first).to_contain_text("with vision")
        expect(first).to_contain_text(str(state["experiences"]))
        expect(second).to_contain_text("without vision")
        view = page.get_by_role("button", name="view 0:00.0")
        expect(view).to_have_attribute(
            "title", "Since tick 0: with vision sees view #0, without vision no view. Show that moment."
        )
        differing = page.locator("#beside-changed")
        expect(differing.locator("summary")).to_have_attribute("title", "local_view.enabled: on → off")
        differing.locator("summary").click()
        expect(differing.locator("tbody tr")).to_have_text("local_view.enabledonoff")
        page.keyboard.press("Escape")
        expect(differing.locator("tbody")).to_be_hidden()
        assert state["beside"]["changed"] == [{"name": "local_view.enabled", "first": True, "second": False}]
        view.click()
        program.wait(lambda state: state["tick"] == 1)
        expect(page.locator("#past")).to_be_visible()
        page.keyboard.press("n")
        program.wait(lambda state: state["tick"] == 300)
        page.get_by_role("button", name="End the comparison").click()
        expect(page.locator("#beside")).to_be_hidden()
        page.get_by_role("button", name="Events", exact=True).click()
        expect(page.locator("#event-list")).to_contain_text("the comparison ends: after 30 s with vision")


@pytest.mark.long
def test_the_menu_names_what_would_really_begin(program: Program, browser: Browser) -> None:
    program.command("use_preset", name="paper-2006")
    for axis in ("x", "y"):
        program.command("set_parameter", name=f"pose_cells.n_{axis}", value=8)
    with open_page(browser, program.url, stage=False) as page:
        page.get_by_label("Compare brains").click()
        anew = page.locator("#brains-anew button > span")
        expect(anew).to_have_text(
            ["Ours", "Without vision", "64 x 64 pose cells", "Learning rate 0.15", "No map, as in 2004"]
        )
        page.get_by_role("button", name="64 x 64 pose cells").click()
        told(page, "Two brains, the same senses")
        expect(page.locator("#beside-first")).to_contain_text("8 x 8 cells")
        expect(page.locator("#beside-second")).to_contain_text("64 x 64 cells")
    program.command("end_comparison")
    program.command("use_preset", name="ours")
    for axis in ("x", "y"):
        program.command("set_parameter", name=f"pose_cells.n_{axis}", value=64)
    program.command("reset", seed=5)


@pytest.mark.long
def test_one_addition_is_chosen_by_its_name_and_the_strip_tells_what_differs(
    program: Program, browser: Browser
) -> None:
    with open_page(browser, program.url, stage=False) as page:
        page.get_by_label("Compare brains").click()
        chosen = page.get_by_label("Or switch one of our additions in the second:")
        expect(chosen.locator("option")).to_have_count(len(ADDITIONS))
        begin, go_on = page.locator("#brains-addition-anew"), page.locator("#brains-addition-now")
        chosen.select_option("exact solver")
        expect(page.locator("#brains-about")).to_contain_text(": sweeps alone lag behind a growing map.")
        expect(go_on).to_be_hidden()
        chosen.select_option("carry")
        expect(go_on).to_have_text("From now on without it")
        expect(begin).to_have_text("Begin again without it")
        begin.click()
        told(page, "Two brains, the same senses")
        expect(page.locator("#beside-first")).to_contain_text("ours")
        expect(page.locator("#beside-second")).to_contain_text("without carry")
        differing = page.locator("#beside-changed")
        differing.locator("summary").click()
        expect(differing.locator("thead")).to_contain_text("without carry")
        expect(differing.locator("tbody tr")).to_have_text("pose_cells.carryonoff")
        page.keyboard.press("Escape")
        program.command("end_comparison")
        program.command("set_parameter", name="pose_cells.carry", value=False)
        page.get_by_label("Compare brains").click()
        expect(chosen).to_have_value("carry")
        expect(chosen.locator("optgroup").last.locator("option")).to_have_text(["carry"])
        expect(go_on).to_have_text("From now on with it")
        go_on.click()
        expect(page.locator("#beside-second")).to_contain_text("with carry")
        expect(differing.locator("summary")).to_have_attribute("title", "pose_cells.carry: off → on")
    program.command("end_comparison")
    program.command("set_parameter", name="pose_cells.carry", value=True)
    program.command("reset", seed=5)


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

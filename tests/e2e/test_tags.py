"""Places named on the page: the robot is tagged, sent elsewhere, and sent back by a click on the name."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from tests.e2e.browser import open_page
from tests.e2e.program import Program


def test_a_place_is_named_and_a_click_on_its_name_is_a_goal(program: Program, browser: Browser) -> None:
    program.command("pause")
    program.command("reset", seed=5)
    program.command("step", ticks=300)
    with open_page(browser, program.url, stage=False) as page:
        page.get_by_role("tab", name="Office").click()
        panel = page.get_by_role("tabpanel", name="Office")
        expect(panel).to_contain_text("None has a name yet")
        for name in ("the kitchen", "the desk"):
            panel.get_by_label("name of this place").fill(name)
            panel.get_by_role("button", name="Robot is here").click()
            expect(panel.get_by_role("button", name=f"go to {name}")).to_be_visible()
            program.command("step", ticks=200)
        expect(panel.get_by_label("name of this place")).to_have_value("")
        chosen = []
        for name in ("the kitchen", "the desk"):  # the goal is changed on the way
            panel.get_by_role("button", name=f"go to {name}").click()
            known = chosen[-1] if chosen else None
            state = program.wait(
                lambda state, known=known: (state["goal"] or {}).get("experience") not in (None, known)
            )
            chosen.append(state["goal"]["experience"])
            assert state["mode"] == "goal"
        panel.get_by_role("button", name="forget the name the kitchen").click()
        expect(panel.get_by_role("button", name="go to the kitchen")).to_have_count(0)
        assert program.state()["goal"]["experience"] == chosen[-1]  # on the way, all the same
        program.command("tag", name="the kitchen")
        program.command("untag", name="the desk")
        expect(panel.get_by_role("button", name="go to the kitchen")).to_be_visible()  # others see it, too
    program.command("cancel_goal")

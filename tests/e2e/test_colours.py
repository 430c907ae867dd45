"""Colours: those of the plates in the panel, in both themes; and those of the system instead of the page's own."""

from __future__ import annotations

from io import BytesIO

import pytest
from PIL import Image
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import calm, open_page, turn_theme, until
from tests.e2e.program import Program
from web.themes import Theme
from web.viewer.primitives.palette import palette_of

pytestmark = pytest.mark.long

THEMES: tuple[Theme, Theme] = ("dark", "light")
NAMED = "(name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim()"
BROKEN = """() => [...document.querySelectorAll("[role=tabpanel]:not([hidden]) th")]
    .filter((cell) => cell.getClientRects().length && cell.clientHeight > 30).map((cell) => cell.textContent)"""


def test_the_panel_has_the_colours_of_the_plates_and_its_words_one_line(program: Program, browser: Browser) -> None:
    program.command("step", ticks=600)
    with open_page(browser, program.url, stage=False) as page:
        for name, words in ("Memory", "links of the goal memory"), ("Inspect", "energy now"):
            page.get_by_role("tab", name=name, exact=True).click()
            panel = page.get_by_role("tabpanel", name=name)
            if name == "Inspect":
                panel.get_by_role("button", name="experience", exact=True).click()
            expect(panel).to_contain_text(words)
            assert page.evaluate(BROKEN) == []
        page.get_by_role("tab", name="Truth").click()
        plot = "document.querySelector('#panel-truth canvas')?.toDataURL()"
        before = ""
        for theme in THEMES:
            shown = [page.evaluate(NAMED, f"--packet-{k + 1}") for k in range(4)]
            assert shown == ["#{:02x}{:02x}{:02x}".format(*colour) for colour in palette_of(theme).packets]
            until(page, f"(before) => ({plot} ?? before) !== before", argument=before)  # plots are drawn anew
            before = page.evaluate(f"() => {plot}")
            turn_theme(page)


def colours(page: Page, part: str) -> list[tuple[int, ...]]:
    """The colours that fill a twentieth of a part and more, as they are seen."""
    image = Image.open(BytesIO(page.locator(part).first.screenshot())).convert("RGB")
    counts: list[tuple[int, tuple[int, ...]]] = image.getcolors(image.width * image.height)  # type: ignore[assignment]
    return [colour for count, colour in counts if count * 20 >= image.width * image.height]


@pytest.mark.parametrize("light", [True, False])
def test_with_the_system_s_own_colours_nothing_is_told_by_colour_alone(
    program: Program, browser: Browser, light: bool
) -> None:
    with open_page(browser, program.url, stage=False, light=light) as page:
        page.emulate_media(forced_colors="active")
        page.wait_for_selector("#panel .bar .across")
        page.evaluate(
            """() => { // kept apart from what the panel shows anew
                const box = document.createElement("div"), square = (tone) =>
                    `<p class="verdict" id="square-${tone}" data-tone="${tone}"><i></i></p>`;
                box.innerHTML = `<div class="bar" id="a-bar" data-tone="new"><span class="fill"></span>
                    <span class="across"></span></div>${square("known")}${square("new")}`;
                for (const [part, width] of [[".fill", "30%"], [".across", "30px"]]) box.querySelector(part).style.width = width;
                box.querySelector(".across").style.left = "70%";
                for (const part of box.querySelectorAll("i")) part.style.width = part.style.height = "20px";
                document.querySelector("#panel .tabpanel:not([hidden])").prepend(box);
            }"""
        )
        calm(page)
        assert len(colours(page, "#a-bar")) >= 3  # ground, fill, threshold
        known, new = (colours(page, f"#square-{tone} i") for tone in ("known", "new"))
        assert known != new
        assert len(new) == 2
        chosen, other = (colours(page, f"#panel [role=tab][aria-selected={chosen}]") for chosen in ("true", "false"))
        assert not set(chosen[:1]) & set(other[:1])
        pressed, free = (colours(page, f".views [aria-pressed={pressed}]") for pressed in ("true", "false"))
        assert max(pressed) != max(free) or min(pressed) != min(free)

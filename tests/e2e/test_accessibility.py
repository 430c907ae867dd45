"""The page by keyboard alone, and with the colours of the system instead of its own."""

from __future__ import annotations

from io import BytesIO

import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from tests.e2e.browser import calm, open_page


def test_a_key_right_after_a_dialog_has_its_meaning(program, browser):
    """Until the next frame the focus is still where it was in the closed dialog."""
    pressed = """() => document.activeElement.dispatchEvent(
        new KeyboardEvent("keydown", { key: "c", code: "KeyC", bubbles: true }))"""
    with open_page(browser, program.url, stage=False) as page:
        page.keyboard.press("/")
        expect(page.locator("#places-typed")).to_be_focused()
        page.evaluate(pressed)  # a letter of what is looked for
        expect(page.locator("#lessons-dialog")).to_be_hidden()
        page.evaluate(f"() => {{ document.getElementById('places-dialog').close(); ({pressed})(); }}")
        expect(page.locator("#lessons-dialog")).to_be_visible()


def colours(page: Page, part: str) -> list[tuple[int, ...]]:
    """The colours that fill a twentieth of a part and more, as they are seen."""
    image = Image.open(BytesIO(page.locator(part).first.screenshot())).convert("RGB")
    counts: list[tuple[int, tuple[int, ...]]] = image.getcolors(image.width * image.height)  # type: ignore[assignment]
    return [colour for count, colour in counts if count * 20 >= image.width * image.height]


@pytest.mark.long
@pytest.mark.parametrize("light", [True, False])
def test_with_the_system_s_own_colours_nothing_is_told_by_colour_alone(program, browser, light):
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

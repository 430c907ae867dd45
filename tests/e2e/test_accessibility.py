"""axe finds no fault in the page and its documents, dark and light, wide and narrow; the keyboard reaches everything."""

from __future__ import annotations

import importlib.resources
from io import BytesIO

import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from tests.e2e.browser import NO_STAGE, PATIENCE_MS, at_each, calm, open_page, turn_theme, until

AXE = importlib.resources.files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")
# Asked for violations alone, axe does half the work: it keeps one node for each rule that is kept.
RUN = """async () => (await axe.run(document, {iframes: false, resultTypes: ["violations"]})).violations.map(
    (found) => `${found.impact}: ${found.help}: ${found.nodes.map((node) => node.html.slice(0, 120)).join(" ")}`)"""


CONTROLS = """() => [...document.querySelectorAll("button, select, summary")]
    .filter((part) => part.checkVisibility() && !part.closest(".toast")) // which comes and goes; Escape takes it away
    .filter((part) => part.tabIndex >= 0) // the other tabs of the panel: arrows reach them
    .map((part) => part.id || part.getAttribute("aria-label") || part.textContent)"""


def findings(page: Page) -> list[str]:
    calm(page)  # what is half transparent while it appears has no contrast
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(AXE)
    return page.evaluate(RUN)


@pytest.mark.parametrize("size", [(1280, 800), (390, 844), (360, 740)])
def test_axe_finds_nothing(program, browser, size):
    with open_page(browser, program.url, *size, stage=size[0] == 1280) as page:
        if size[0] < 500:
            page.click("#more")
        for _ in range(2):
            calm(page)
            assert findings(page) == []
            turn_theme(page)
        page.keyboard.press("?")
        assert findings(page) == []


@pytest.mark.long
def test_axe_finds_nothing_before_the_server_has_said_anything(program, browser):
    with browser.new_context(viewport={"width": 1440, "height": 900}) as context:
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        page.route("**/viser/**", lambda route: route.fulfill(content_type="text/html", body=NO_STAGE))
        page.route_web_socket("**/api/stream**", lambda _socket: None)  # open, and silent
        page.goto(program.url)
        page.wait_for_selector("#panel-senses canvas")
        calm(page)
        assert findings(page) == []


@pytest.mark.long
def test_axe_finds_nothing_in_the_documents(program, browser):
    with browser.new_context() as context:
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        page.goto(f"{program.url}docs")
        page.wait_for_selector("#commands article")
        assert findings(page) == []
        page.select_option("#which", label="pause")
        page.click("text=Send")
        page.wait_for_selector("#answer:has-text('accepted')")


@pytest.mark.long
@pytest.mark.parametrize("widths", [(360, 390), (760, 1024, 1440)], ids=["phones", "screens"])
def test_nothing_sticks_out(program, browser, widths):
    with open_page(browser, program.url, widths[0], 740, stage=False) as page:
        program.command("kidnap")
        for width, _ in at_each(page, [(width, 740) for width in widths]):
            nothing_sticks_out_at(page, width)


def nothing_sticks_out_at(page: Page, width: int) -> None:
    if width > 860:
        until(page, "() => document.querySelector('#panel-senses canvas').checkVisibility()")  # the panel is filled
    assert page.evaluate("() => document.documentElement.scrollWidth") <= width
    sticking_out = """() => [...document.querySelectorAll("button, select, summary, p, section")]
        .filter((part) => part.checkVisibility() && !part.closest("dialog, details .pop"))
        .filter((part) => { const box = part.getBoundingClientRect();
            const below = box.bottom > innerHeight + 1 && !part.closest("[role=tabpanel]");  // which can be scrolled
            return box.width && (box.right > innerWidth + 1 || box.left < -1 || below); })
        .map((part) => part.id || part.textContent.slice(0, 40))"""
    assert page.evaluate(sticking_out) == []
    if width < 500:
        small = """() => [...document.querySelectorAll(".pad button, .views button, .transport button, #more")]
            .filter((part) => part.checkVisibility())
            .filter((part) => Math.min(part.getBoundingClientRect().height, part.getBoundingClientRect().width) < 43)
            .map((part) => part.textContent || part.id)"""
        assert page.evaluate(small) == []


def test_the_keyboard_reaches_every_control(program, browser):
    with open_page(browser, program.url) as page:
        wanted = set(page.evaluate(CONTROLS))
        reached = set()
        for _ in range(80):
            page.keyboard.press("Tab")
            reached.add(
                page.evaluate("""() => { const part = document.activeElement;
                return part.id || part.getAttribute("aria-label") || part.textContent; }""")
            )
        assert wanted - reached == set()


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

"""What can be wrong with how a page looks: something is covered, cut, too small for who presses it, or fails axe."""

from __future__ import annotations

import importlib.resources

from playwright.sync_api import Page

from tests.e2e.browser import calm

# Each of these stands alone; what lies in one of them may not cover its neighbours there either.
PARTS = """header, footer, #stage, #line, .views, .aids, #panel, #panel-show, #beside, #lesson, #presenter-bar, .pad"""
BOXES = """([parts, least]) => {
    const wrong = [], name = (part) => part.id || part.className || part.tagName;
    const shown = (part) => part.checkVisibility({ visibilityProperty: true }) && part.getBoundingClientRect().width > 0;
    const all = [...document.querySelectorAll(parts)].filter(shown);
    const apart = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) <= 0.5
        || Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) <= 0.5;
    const scrolls = getComputedStyle(document.documentElement).overflowY !== "hidden"; // the page as a whole
    for (const line of document.querySelectorAll("#beside .since")) line.scrollLeft = line.scrollWidth;
    const bottom = scrolls ? document.documentElement.scrollHeight : innerHeight;
    const on_its_side = matchMedia("(pointer: coarse) and (max-height: 500px) and (min-width: 560px)").matches; // a phone
    const folded = on_its_side && document.getElementById("lesson")?.dataset.folded === "true";
    if (document.documentElement.scrollWidth > innerWidth) wrong.push("the page is wider than the window");
    for (const part of document.querySelectorAll("dialog[open], #time"))
        if (shown(part) && part.scrollWidth > part.clientWidth) wrong.push(`${name(part)} is wider than it shows`);
    for (const [k, part] of all.entries()) {
        const box = part.getBoundingClientRect();
        if (box.left < -0.5 || box.right > innerWidth + 0.5 || box.top < -0.5 || box.bottom > bottom + 0.5)
            wrong.push(`${name(part)} sticks out`);
        for (const other of all.slice(k + 1)) {
            const sheets = [...innerWidth <= 1000 ? ["panel"] : [], ...innerWidth <= 760 || folded ? ["lesson"] : []];
            const thumb = on_its_side && part.id === "stage" && other.matches(".pad");
            const sheet = thumb || sheets.includes(part.id) || sheets.includes(other.id);
            if (!sheet && !part.contains(other) && !other.contains(part) && !apart(box, other.getBoundingClientRect()))
                wrong.push(`${name(part)} and ${name(other)} cover one another`);
        }
    }
    const room = document.getElementById("panel")?.getBoundingClientRect();
    for (const part of document.querySelectorAll("[role=tabpanel]:not([hidden]) *")) {
        const box = part.getBoundingClientRect();
        if (shown(part) && !part.closest(".gone, svg, .u-wrap") && (box.right > room.right + 1 || box.left < room.left - 1))
            wrong.push(`${name(part)} sticks out of its tab`);
    }
    for (const part of document.querySelectorAll("#lesson :is(h2, p, button, label, legend, li, figure)"))
        if (shown(part) && part.clientWidth && part.scrollWidth > part.clientWidth + 1) wrong.push(`${name(part)} is cut`);
    const scrolled = (part) => { // out of sight in something that can be scrolled to it
        for (let up = part.parentElement; up; up = up.parentElement)
            if (/auto|scroll/.test(getComputedStyle(up).overflow)
                && (up.scrollHeight > up.clientHeight || up.scrollWidth > up.clientWidth)) return true;
        return false;
    };
    const over = ["dialog[open]", "details[open] > .pop", "#editor", "#events-box", ...innerWidth <= 1000 ? ["#panel"] : []];
    const modal = [...document.querySelectorAll(over.join())].some(shown); // it may lie over all else
    const pressed = [...document.querySelectorAll("button, select, summary, [role=tab]")].filter(shown);
    for (const part of pressed.filter((part) => !part.closest("#panel, dialog, #timeline, .pop, #editor"))) {
        const box = part.getBoundingClientRect();
        if (Math.min(box.width, box.height) < least - 0.5)
            wrong.push(`${name(part)} is ${box.width.toFixed(0)} x ${box.height.toFixed(0)}`);
        if (part.tagName !== "SELECT" && part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflow !== "visible")
            wrong.push(`${name(part)} is cut`);
        if (part.matches("#beside-end")) { // it stays, however far its line is scrolled
            const line = part.parentElement.getBoundingClientRect();
            if (box.left < line.left - 0.5 || box.right > line.right + 0.5) wrong.push(`${name(part)} is out of sight`);
        }
        if (modal || scrolled(part)) continue;
        const at = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
        if (at && !part.contains(at) && !at.contains(part) && !at.closest("label")?.contains(part))
            wrong.push(`${name(part)} is beneath ${name(at)}`);
    }
    return wrong; }"""
# A control counts when its middle is what a click there would meet; a word when its own text box is in the window.
IN_SIGHT = """() => {
  const seen = (part, rect) => rect.width > 1 && rect.height > 1 && rect.bottom > 0 && rect.right > 0 && rect.top < innerHeight
    && rect.left < innerWidth && part.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  const on_top = (part, rect) => { const hit = document.elementFromPoint(rect.left + rect.width / 2, rect.top + rect.height / 2);
    return hit !== null && (part.contains(hit) || hit.contains(part)); };
  const controls = [...document.querySelectorAll("button, select, input, summary, a[href], textarea, [role=slider], [role=tab]")]
    .filter((part) => { const rect = part.getBoundingClientRect(); return seen(part, rect) && on_top(part, rect); });
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let words = 0;
  while (walker.nextNode()) {
    const part = walker.currentNode.parentElement, text = walker.currentNode.textContent.trim();
    if (!text || part.closest(".gone, script, style, select, svg") || part.closest("dialog:not([open])")) continue;
    const range = document.createRange(); range.selectNodeContents(walker.currentNode);
    if (seen(part, range.getBoundingClientRect())) words += text.split(/\\s+/).length;
  }
  return [controls.map((part) => part.id || part.getAttribute("aria-label") || part.textContent.trim()), words];
}"""
FOR_FINGERS = """() => [...document.querySelectorAll("button, select, summary, [role=tab], label.check, .pop a, .option")]
    .filter((part) => part.checkVisibility({ visibilityProperty: true }) && !part.closest(".gone"))
    .map((part) => [part, part.getBoundingClientRect()])
    .filter(([part, { width, height }]) => Math.min(width, height) < 43.5 || part.scrollWidth > part.clientWidth + 1
        && getComputedStyle(part).overflow !== "visible" && getComputedStyle(part).textOverflow !== "ellipsis")
    .map(([part, { width, height }]) => `${part.id || part.textContent || part.ariaLabel}: ${width} x ${height}`)"""
CONTROLS = """() => [...document.querySelectorAll("button, select, summary")]
    .filter((part) => part.checkVisibility() && !part.closest(".toast")) // which comes and goes; Escape takes it away
    .filter((part) => part.tabIndex >= 0 && !part.disabled) // the other tabs of the panel: arrows reach them
    .map((part) => part.id || part.getAttribute("aria-label") || part.textContent)"""
FOCUSED = """() => { const part = document.activeElement;
    return part.id || part.getAttribute("aria-label") || part.textContent; }"""
AXE = importlib.resources.files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8")
# Asked for violations alone, axe does half the work: it keeps one node for each rule that is kept.
RUN = """async (part) => (await axe.run(part, {iframes: false, resultTypes: ["violations"]})).violations.map(
    (found) => `${found.impact}: ${found.help}: ${found.nodes.map((node) => node.html.slice(0, 120)).join(" ")}`)"""


def boxes(page: Page, fingers: bool = False) -> list[str]:
    """What is covered, cut, out of the window, or smaller than WCAG 2.2 has it: 24 pixels, 44 for fingers."""
    calm(page)
    return page.evaluate(BOXES, [PARTS, 44 if fingers else 24]) + (page.evaluate(FOR_FINGERS) if fingers else [])


def findings(page: Page, part: str = "html") -> list[str]:
    """What axe finds in a part of it."""
    calm(page)  # what is half transparent while it appears has no contrast
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(AXE)
    return page.evaluate(RUN, part)


def unreached(page: Page) -> set[str]:
    """The controls to which Tab does not come."""
    wanted, reached = set(page.evaluate(CONTROLS)), set[str]()
    for _ in range(2 * len(wanted)):
        page.keyboard.press("Tab")
        reached.add(page.evaluate(FOCUSED))
        if wanted <= reached:
            break
    page.evaluate("() => document.activeElement.blur()")
    return (wanted - reached) & set(page.evaluate(CONTROLS))  # a list of views may still be drawn anew

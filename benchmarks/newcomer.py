"""A newcomer's first visit, with a stopwatch: `python -m benchmarks.newcomer [SEED ...]`. Bars: 120 s, 60 words to read.

It does what the card says, at the speed that the page begins with: *Quickly*, a click on the map at the far end of it, then, when
the robot has arrived, *Kidnap* to wherever chance will have it, and *Quickly* once more when that has not ended in ten seconds.
Before each act it waits as long as a person who reads and aims. It counts all words of the card, whether all of them come up or
not, and those of the hints and messages that do.
"""

from __future__ import annotations

import statistics
import sys
import time

from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.machine import verdict
from tests.e2e.browser import launch, on_screen, open_page, show, until
from tests.e2e.program import Program
from tests.e2e.test_first_visit import far_node, is_done

BAR_S, BAR_WORDS = 120.0, 60
READ_S, AIM_S, WATCH_S = 5.0, 2.0, 10.0
KEEP_SHOWN = """() => { const look = () => { for (const part of document.querySelectorAll(".hints, #until, #kept"))
        if (part.checkVisibility()) toasted.add(part.innerText); };
    look(); new MutationObserver(look).observe(document, { subtree: true, childList: true, attributes: true }); }"""
TEXTS = """() => { const card = document.getElementById("first").cloneNode(true);
    for (const part of card.querySelectorAll(".gone")) part.remove(); // said aloud only
    return [card.textContent, ...toasted].map((text) => text.trim().split(/\\s+/).join(" ")); }"""


def main(seeds: list[int]) -> int:
    found = list[tuple[float, float, int]]()  # at its goal, found again, words
    with sync_playwright() as playwright:
        browser = launch(playwright)
        for seed in seeds:
            program = Program("--port", "0", "--seed", str(seed))
            try:
                goal_s, kidnap_s, texts = visit(browser, program)
            except AssertionError as error:  # a step that was not seen to be done in time
                print(f"seed {seed}: {error}: {verdict(met=False)}", flush=True)
                continue
            finally:
                program.stop()
            found.append((goal_s, kidnap_s, sum(len(text.split()) for text in texts)))
            print(
                f"seed {seed}: at its goal after {goal_s:.0f} s, found again after {kidnap_s:.0f} s, {found[-1][2]} words, "
                f"of them beside the card: {texts[1:]}",
                flush=True,
            )
        browser.close()
    if not found:
        return 0
    all_s, words = [kidnap_s for _, kidnap_s, _ in found], max(words for *_, words in found)
    print(
        f"{statistics.median(all_s):.0f} s in the median, {max(all_s):.0f} s at worst: {verdict(max(all_s) <= BAR_S)}"
    )
    print(f"{words} words: {'met' if words <= BAR_WORDS else 'MISSED'}")
    return words > BAR_WORDS


def visit(browser: Browser, program: Program) -> tuple[float, float, list[str]]:
    """Seconds until the goal is reached and until the robot is found again, and all there was to read, the card first."""
    began_s = time.monotonic()
    with open_page(browser, program.url, first=True) as page:
        page.evaluate(KEEP_SHOWN)
        wait(page, READ_S)
        page.click("#first-explore")
        is_done(page, 0)
        until(page, "() => document.getElementById('first-share').hidden")
        show(page, "map")
        wait(page, AIM_S)
        page.mouse.click(*on_screen(page, "map", far_node(program)))
        is_done(page, 1)
        goal_s = time.monotonic() - began_s
        wait(page, AIM_S)
        page.click("#kidnap")
        wait(page, WATCH_S)
        if page.locator("#first-find").is_visible():
            page.click("#first-find")
        is_done(page, 2)
        kidnap_s = time.monotonic() - began_s
        wait(page, AIM_S)  # what is said afterwards counts too
        return goal_s, kidnap_s, page.evaluate(TEXTS)


def wait(page: Page, seconds: float) -> None:
    page.wait_for_timeout(1000 * seconds)


if __name__ == "__main__":
    raise SystemExit(main([int(word) for word in sys.argv[1:]] or [31, 32, 33, 34, 35]))

"""How soon a lesson's scene is set, and how long all of them take as tests: `python -m benchmarks.lessons`. Bars: 2 s, 180 s.

The clock starts with the click on the lesson in the list of a real page, and stops when its card asks the question. The viewer's
frame is left out: without a graphics card its drawing would dominate. The rounds after the first are not waited for: each begins
when the class has seen the one before.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time

from playwright.sync_api import Page, sync_playwright

from app.protocol.lesson import Lesson, catalogue
from benchmarks.machine import verdict
from tests.e2e.browser import launch, open_page
from tests.e2e.program import Program

SCENE_BAR_S, TESTS_BAR_S = 2.0, 180.0
ASKS = """([name, title]) => new Promise((asked) => {
    const began = performance.now(), card = document.getElementById("lesson");
    document.querySelector(`#lessons-list [data-name="${name}"]`).click();
    const look = () => {
        const ready = card.dataset.state === "predict" && !card.hidden
            && document.getElementById("lesson-title").textContent === title;
        ready ? asked(performance.now() - began) : setTimeout(look, 5);
    };
    setTimeout(look, 5);
})"""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--times", type=int, default=3, help="how often each scene is set")
    parser.add_argument("--no-tests", action="store_true", help="leave out the tests")
    options = parser.parse_args()
    worst_s = _scenes(options.times)
    print(f"the slowest scene: {worst_s:.2f} s, bar {SCENE_BAR_S:g} s: {verdict(worst_s <= SCENE_BAR_S)}")
    if options.no_tests:
        return 0
    began_s = time.monotonic()
    passed = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-n0", "tests/integration/test_lessons.py"], check=False
    )
    tests_s = time.monotonic() - began_s
    held = verdict(tests_s <= TESTS_BAR_S)
    print(f"all lessons as tests, one after the other: {tests_s:.0f} s, bar {TESTS_BAR_S:g} s: {held}")
    return passed.returncode


def _scenes(times: int) -> float:
    """Prints each lesson's times; the median of the slowest lesson, in s."""
    program = Program("--port", "0", "--seed", "5", "--paused")
    try:
        with sync_playwright() as playwright:
            browser = launch(playwright)
            with open_page(browser, program.url, stage=False) as page:
                medians_s = {each.name: _scene(page, each, times) for each in catalogue()}
            browser.close()
    finally:
        program.stop()
    return max(medians_s.values())


def _scene(page: Page, lesson: Lesson, times: int) -> float:
    name, found_s = lesson.name, list[float]()
    for _ in range(times):
        page.click("#lessons")
        page.wait_for_selector(f"#lessons-list [data-name={name}]")
        found_s.append(page.evaluate(ASKS, [name, lesson.title]) / 1000)
        page.click("#lesson-leave")  # or the card of the last time would be taken for that of the next
        page.wait_for_selector("#lesson", state="hidden")
    print(f"{name:14} {statistics.median(found_s):5.2f} s in the median, {max(found_s):5.2f} s at worst", flush=True)
    return statistics.median(found_s)


if __name__ == "__main__":
    raise SystemExit(main())

"""What is in sight at first: `python -m benchmarks.calm [FOLDER] [--only NAME]`. Bar: 18 controls at the first visit, 1280 x 720.

It opens the page as a newcomer would and, three simulated minutes later, as somebody who knows it, at the sizes of a laptop, a
lecture hall and a phone. It counts controls and words that can be seen, and how much of each plate is covered by what lies on the
stage. With a folder it leaves a picture of each there, and the two of the README: on the way to a place, and just after a kidnap.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.machine import verdict
from tests.e2e.browser import draw, launch, open_page
from tests.e2e.layout import IN_SIGHT
from tests.e2e.program import Program

BAR = 18
MINUTES, README_MINUTES = 3, 16
STRIDE = 300  # ticks that one request may ask for


@dataclass(frozen=True)
class Sight:
    """A way to look at the page."""

    name: str
    width: int
    height: int
    light: bool = False
    first: bool = False
    keys: str = ""  # pressed before the look
    level: str = "watch"
    story: Callable[[Program], None] | None = None  # what happens before


def to_the_library(program: Program) -> None:
    """On its way, after sixteen minutes."""
    walk(program, 600 * README_MINUTES)
    (library,) = (place for place in program.places()["named"] if place["name"] == "library")
    program.command("set_goal", x=library["x"], y=library["y"])
    program.command("step", ticks=10)


def kidnapped(program: Program) -> None:
    """Half a second after it was carried to the other side of the office."""
    program.command("cancel_goal")
    program.command("set_mode", mode="explore")
    walk(program, 600 * README_MINUTES + 300)
    program.command("kidnap", x=2.0, y=3.0, heading_rad=0.0)
    program.command("step", ticks=5)


SIGHTS = [
    Sight("first-visit", 1280, 720, first=True),
    Sight("first-visit-phone", 390, 844, first=True),
    Sight("laptop", 1280, 720),
    Sight("laptop-light", 1280, 720, light=True),
    Sight("hall", 1920, 1080),
    Sight("hall-light", 1920, 1080, light=True),
    Sight("phone", 390, 844),
    Sight("phone-light", 390, 844, light=True),
    Sight("presenting", 1280, 720, keys="z"),
    Sight("explore", 1280, 720, level="explore"),
    Sight("lab", 1280, 720, level="lab"),
    Sight("lab-hall", 1920, 1080, level="lab"),
    Sight("readme", 1440, 900, light=True, level="explore", story=to_the_library),
    Sight("kidnapped", 1280, 720, story=kidnapped),
]


def main(folder: Path | None, only: str | None) -> int:
    """only: one of the sights, by name."""
    program, most = Program("--port", "0", "--seed", "3"), 0
    try:
        with sync_playwright() as playwright:
            browser = launch(playwright)
            for sight in sorted(SIGHTS, key=lambda sight: not sight.first):
                if only not in (None, sight.name):
                    continue
                if sight.story is not None:
                    sight.story(program)
                elif not sight.first:
                    walk(program, 600 * MINUTES)
                controls, words = look(browser, program, sight, folder)
                print(f"{sight.name:18} {len(controls):3} controls, {words:3} words: {', '.join(controls)}", flush=True)
                if sight.name == "first-visit":
                    most = len(controls)
            browser.close()
    finally:
        program.stop()
    print(f"{most} controls at the first visit: {verdict(most <= BAR)}")
    return int(most > BAR)


def walk(program: Program, until: int) -> None:
    """Let the robot know some of the office, up to this tick."""
    while (missing := until - program.state()["tick"]) > 0:
        program.command("step", ticks=min(missing, STRIDE))


def look(browser: Browser, program: Program, sight: Sight, folder: Path | None) -> tuple[list[str], int]:
    with open_page(
        browser, program.url, sight.width, sight.height, light=sight.light, first=sight.first, level=sight.level
    ) as page:
        if sight.keys:
            page.keyboard.press(sight.keys)
        settle(page)
        if sight.story is not None and (hint := page.get_by_role("button", name="Dismiss")).is_visible():
            hint.click()  # that there is no graphics card
            settle(page)
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            page.screenshot(path=folder / f"{sight.name}.jpg", type="jpeg", quality=85)
        controls, words = page.evaluate(IN_SIGHT)
        return controls, words


def settle(page: Page) -> None:
    """Until the stage has been drawn at its size."""
    for _ in range(3):
        draw(page)
        page.wait_for_timeout(700)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--only", choices=[sight.name for sight in SIGHTS])
    args = parser.parse_args()
    sys.exit(main(args.folder, args.only))

"""What a person keeps of the page: pictures of plates and plots, and a film of the stage; other programs open them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import cv2
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.e2e.browser import open_page, show, told
from tests.e2e.program import Program

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def driven(program: Program) -> Program:
    program.command("step", ticks=200)
    return program


def saved(page: Page, folder: Path, press: Callable[[], None]) -> Path:
    with page.expect_download() as loading:
        press()
    file = folder / loading.value.suggested_filename
    loading.value.save_as(file)
    return file


def keep(page: Page, words: str) -> Callable[[], None]:
    def press() -> None:
        page.click("#keep summary")
        page.get_by_role("button", name=words, exact=True).click()

    return press


@pytest.mark.long
def test_plates_of_both_brains_and_plots_as_vectors_and_pixels(
    driven: Program, browser: Browser, tmp_path: Path
) -> None:
    driven.command("compare_brains", values={"local_view.enabled": False}, name="eyes shut", since="now")
    driven.command("step", ticks=20)
    with open_page(browser, driven.url, stage=False, light=True) as page:
        for what, plate in {
            "Office": "office",
            "Pose cells": "pose",
            "Experience map": "map",
            "Pose cells: eyes shut": "pose-2",
            "Experience map: eyes shut": "map-2",
        }.items():
            file = saved(page, tmp_path, keep(page, f"{what} as SVG"))
            assert file.name == f"office-seed5-0m22.0s-{plate}.svg"
            picture = ElementTree.parse(file).getroot()
            assert picture.find(f"{SVG}rect").get("fill") == "#ffffff"  # type: ignore[union-attr]
            assert len(list(picture.iter())) > 30
            if plate.endswith("2"):
                assert next(picture.iter(f"{SVG}text")).text == "eyes shut"
            else:
                pixels = cv2.imread(str(saved(page, tmp_path, keep(page, f"{what} as PNG"))))
                assert pixels.shape[1] == 2 * float(picture.get("width", 0)) == 2000
        driven.command("end_comparison")
        page.click("#keep summary")
        expect(page.locator("#keep-map-2")).to_be_hidden()
        page.keyboard.press("Escape")

        page.get_by_role("tab", name="Truth").click()
        expect(page.locator(".plot canvas").first).to_be_visible()
        svg, png = (
            saved(page, tmp_path, page.get_by_role("button", name=f"Errors against time: save as {kind}").click)
            for kind in ("SVG", "PNG")
        )
        paths = ElementTree.parse(svg).getroot().iter(f"{SVG}path")
        lines = [path.get("d", "") for path in paths if path.get("stroke-linejoin") == "round"]
        assert [line.count("L") > 10 for line in lines] == [True, True]
        assert png.name.endswith("-errors-against-time.png")
        pixels = cv2.imread(str(png))
        assert pixels.shape[:2] == (840, 1800)
        assert pixels.std() > 10


@pytest.mark.long
def test_the_stage_as_a_picture_and_as_a_film(driven: Program, browser: Browser, tmp_path: Path) -> None:
    with open_page(browser, driven.url, 780, 500) as page:
        show(page, "map")
        shape = page.evaluate(
            "() => [...document.querySelector('#stage').contentDocument.querySelectorAll('canvas')]"
            ".map((canvas) => [canvas.height, canvas.width]).sort((a, b) => b[0] * b[1] - a[0] * a[1])[0]"
        )
        pixels = cv2.imread(str(saved(page, tmp_path, keep(page, "Picture of the stage (PNG)"))))
        assert pixels.shape[1] / pixels.shape[0] == pytest.approx(
            shape[1] / shape[0], rel=0.02
        )  # viser draws fewer pixels
        assert pixels.std() > 5

        keep(page, "Film from a to b")()
        told(page, "Mark a stretch first, with a and b above the timeline")
        driven.command("loop", begin_s=5.0, end_s=8.0)
        expect(page.locator("#loop-off")).to_be_attached()
        keep(page, "Film from a to b")()
        expect(page.locator("#film")).to_be_visible()
        page.click("#film-cancel")
        expect(page.locator("#film")).to_be_hidden()
        told(page, "The film was cancelled.")
        file = saved(page, tmp_path, keep(page, "Film from a to b"))
        assert file.name == "office-seed5-0m05.0s-to-0m08.0s.webm"
        assert not driven.state()["running"]
        film, pictures = cv2.VideoCapture(str(file)), []
        while (read := film.read())[0]:
            pictures.append(read[1])
        assert len(pictures) >= 2
        high, wide = pictures[-1].shape[:2]  # ... when it is slow
        assert wide / high == pytest.approx(shape[1] / shape[0], rel=0.02)
        assert pictures[-1].std() > 5
        driven.command("loop")
        driven.command("back_to_now")

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
def test_plates_as_vectors(driven: Program, browser: Browser, tmp_path: Path) -> None:
    seconds = driven.state()["tick"] / 10
    with open_page(browser, driven.url, stage=False, light=True) as page:
        for words, what in (
            ("Office as SVG", "office"),
            ("Pose cells as SVG", "pose"),
            ("Experience map as SVG", "map"),
        ):
            file = saved(page, tmp_path, keep(page, words))
            assert file.name == f"office-seed5-0m{seconds:04.1f}s-{what}.svg"
            pixels = cv2.imread(str(saved(page, tmp_path, keep(page, f"{words.removesuffix(' as SVG')} as PNG"))))
            picture = ElementTree.parse(file).getroot()
            assert pixels.shape[1] == 2 * float(picture.get("width", 0)) == 2000
            assert picture.find(f"{SVG}rect").get("fill") == "#ffffff"  # type: ignore[union-attr]
            assert len(list(picture.iter())) > 30


@pytest.mark.long
def test_of_two_brains_each_has_its_plates(driven: Program, browser: Browser, tmp_path: Path) -> None:
    with open_page(browser, driven.url, stage=False) as page:
        page.click("#keep summary")
        expect(page.get_by_role("button", name="Experience map as SVG")).to_be_visible()
        expect(page.locator("#keep-map-2")).to_be_hidden()
        page.keyboard.press("Escape")
        driven.command("compare_brains", values={"local_view.enabled": False}, name="eyes shut", since="now")
        driven.command("step", ticks=20)
        for what, plate in (("Pose cells", "pose-2"), ("Experience map", "map-2")):
            page.click("#keep summary")
            button = page.get_by_role("button", name=f"{what}: eyes shut as SVG")
            expect(button).to_be_visible()
            file = saved(page, tmp_path, button.click)
            assert file.name.endswith(f"s-{plate}.svg")
            assert next(ElementTree.parse(file).getroot().iter(f"{SVG}text")).text == "eyes shut"
        driven.command("end_comparison")
        page.click("#keep summary")
        expect(page.locator("#keep-map-2")).to_be_hidden()


@pytest.mark.long
def test_plots_as_vectors_and_pixels(driven: Program, browser: Browser, tmp_path: Path) -> None:
    with open_page(browser, driven.url, stage=False) as page:
        page.get_by_role("tab", name="Truth").click()
        expect(page.locator(".plot canvas").first).to_be_visible()
        button = page.get_by_role("button", name="Errors against time: save as SVG")
        picture = ElementTree.parse(saved(page, tmp_path, button.click)).getroot()
        lines = [path for path in picture.iter(f"{SVG}path") if path.get("stroke-linejoin") == "round"]
        assert [line.get("d", "").count("L") > 10 for line in lines] == [True, True]
        button = page.get_by_role("button", name="Errors against time: save as PNG")
        file = saved(page, tmp_path, button.click)
        assert file.name.endswith("-errors-against-time.png")
        pixels = cv2.imread(str(file))
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
        told(page, "The film was given up.")
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

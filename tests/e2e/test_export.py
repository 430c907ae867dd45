"""The menu of exports in a real browser: what can be had now comes as a file, what cannot says why."""

from __future__ import annotations

import zipfile
from pathlib import Path

import networkx as nx
import pytest
from playwright.sync_api import expect

from tests.e2e.browser import open_page, told, until


@pytest.mark.long
def test_the_map_is_saved_for_other_programs(program, browser, tmp_path: Path):
    program.command("step", ticks=50)
    with open_page(browser, program.url, stage=False) as page:

        def saved(words: str) -> Path:
            page.click("#restart summary")
            page.get_by_role("button", name="Export this run").click()
            with page.expect_download() as loading:
                page.get_by_role("button", name=words).click()
            file = tmp_path / loading.value.suggested_filename
            loading.value.save_as(file)
            told(page, f"Saved {file.name}.")
            expect(page.locator("#export-dialog")).to_be_hidden()
            return file

        graph = saved("GraphML")
        assert graph.name == "run-office-seed5.graphml"
        assert len(nx.read_graphml(graph)) > 5
        with zipfile.ZipFile(saved("PNG")) as pictures:
            assert len(pictures.namelist()) == 3


@pytest.mark.long
def test_a_stretch_between_two_marks_and_a_file_that_is_given_up(program, browser):
    program.command("step", ticks=60)
    program.command("loop", begin_s=1.0, end_s=3.0)
    with open_page(browser, program.url, stage=False) as page:
        until(page, "() => document.querySelector('#loop-off').checkVisibility()")
        page.click("#restart summary")
        page.get_by_role("button", name="Export this run").click()
        expect(page.locator("#export-from")).to_have_value("1.0")
        expect(page.locator("#export-until")).to_have_value("3.0")
        expect(page.locator("#export-marks")).to_be_visible()
        mcap = page.get_by_role("button", name="MCAP: ROS 2")
        mcap.click()
        page.click("#export-cancel")
        told(page, "The mcap was not written.")
        expect(page.locator("#export-busy")).to_be_hidden()
        page.select_option("#export-pictures", "none")
        until(
            page, "async () => (await (await fetch('/api/exports/done')).json()) === null"
        )  # the server has given it up
        mcap.click()
        told(page, "Saved run-office-seed5-1s-to-3s.mcap.")
    program.command("loop")

"""What the menu of exports saves in a real browser is read by other programs."""

from __future__ import annotations

import zipfile
from pathlib import Path

import networkx as nx
import pytest
from playwright.sync_api import expect

from tests.e2e.browser import open_page, told


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

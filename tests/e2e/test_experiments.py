"""Trials that were stored: a cell and a dot are clicked, and the trial plays."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.experiments.store import Outcome, Store
from app.protocol.experiment import chosen_trial, find_experiment
from app.protocol.trial import run_trial
from tests.e2e.browser import open_page, told, until
from tests.e2e.program import Program

SAYS = "(words) => document.getElementById('trial').innerText.includes(words)"


@pytest.mark.long
def test_a_cell_and_a_dot_are_clicked_and_the_trial_plays_from_its_moment(browser: Browser, tmp_path: Path) -> None:
    path = tmp_path / "experiments.sqlite"
    trial = chosen_trial(find_experiment("table"), "ours", ["2 %", "8 x 8"], 7, quick=True)
    result, _ = run_trial(trial)
    with Store(path) as store:
        store.add([(trial, Outcome(trial.id, result))])
    program = Program("--port", "0", "--paused", RATSLAM_EXPERIMENTS=str(path))
    with open_page(browser, program.url, stage=False) as page:
        page.keyboard.press("g")
        page.click(".card[data-name=table] .trials")
        cell = page.locator(".cell").and_(page.get_by_label("2 %, 8 x 8: "))
        expect(page.locator("#cell-none")).to_be_visible()  # nothing was run where it begins
        cell.click()
        expect(cell).to_have_attribute("aria-pressed", "true")
        expect(page.locator("#cell-title")).to_have_text("2 %, 8 x 8, our rules")
        expect(page.locator(".dot")).to_have_count(1)
        assert page.locator(".dot").get_attribute("aria-label").startswith("Seed 7: 0 of 3 goals reached. Decided at")
        page.focus(".dot")
        page.keyboard.press("Enter")
        told(page, "Seed 7: going to the moment that decided it.")
        before_s = result.deciding.time_s - 10
        state = program.wait(lambda state: state["trial"]["ahead"] is None and state["time_s"] >= before_s - 0.1)
        assert (state["speed"], state["trial"]["id"]) == (1.0, trial.id)
        assert state["time_s"] < result.deciding.time_s
        assert not any("has changed" in said for said in page.evaluate("() => [...toasted]"))
        program.command("set_speed", factor=0)
        told(page, "The trial is over: 0 of 3 goals reached.")
        until(page, SAYS, argument="over: 0 of 3 goals reached")
        ended = program.state()
        assert not ended["running"]
        assert ended["time_s"] == pytest.approx(result.simulated_s)
        legend = page.evaluate("() => [...document.querySelectorAll('#timeline .mark')].map((one) => one.dataset.kind)")
        assert {"trial", "failed"} <= set(legend)
    assert program.stop() == 0

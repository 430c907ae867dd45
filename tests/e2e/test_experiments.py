"""Trials that were stored: a cell and a dot are clicked, and the trial plays; one is opened from the command line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from app.experiments.outcome import Outcome
from app.experiments.store import Store
from app.trials.chosen import chosen_trial
from app.trials.experiment import find_experiment
from app.trials.trial import Result, Trial, run_trial
from tests.e2e.browser import open_page, told, until
from tests.e2e.program import Program

SAYS = "(words) => document.getElementById('trial').innerText.includes(words)"
TABLE = find_experiment("table")
OPEN = """
from pathlib import Path
from app.cli.run import run_with_trial
from app.cli.serving import Serving
from app.experiments.opening import open_trial
from app.experiments.store import Store
with Store(Path({store!r})) as store:
    opened = open_trial({id!r}, store)
raise SystemExit(run_with_trial(opened.trial, opened.moment_s, serving=Serving(port=0, browser=False)))
"""
Ran = tuple[Trial, Result]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ran]:
    """A store with one short trial that was truly run."""
    path = tmp_path_factory.mktemp("store") / "experiments.sqlite"
    trial = chosen_trial(TABLE, "ours", ["2 %", "8 x 8"], 7, quick=True)
    result, _ = run_trial(trial)
    with Store(path) as store:
        store.add([(trial, Outcome(trial.id, result))])
    return path, (trial, result)


@pytest.fixture(scope="module")
def stored(ran: tuple[Path, Ran]) -> Iterator[Program]:
    made = Program("--port", "0", "--paused", RATSLAM_EXPERIMENTS=str(ran[0]))
    yield made
    assert made.stop() == 0


def trials_of_the_table(page: Page) -> None:
    page.keyboard.press("g")
    page.click(".card[data-name=table] .trials")
    page.wait_for_selector("#one-grid .cell")


@pytest.mark.long
def test_a_cell_and_a_dot_are_clicked_and_the_trial_plays_from_its_moment(
    stored: Program, browser, ran: tuple[Path, Ran]
) -> None:
    trial, result = ran[1]
    with open_page(browser, stored.url, stage=False) as page:
        trials_of_the_table(page)
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
        state = stored.wait(lambda state: state["trial"]["ahead"] is None and state["time_s"] >= before_s - 0.1)
        assert (state["speed"], state["trial"]["id"]) == (1.0, trial.id)
        assert state["time_s"] < result.deciding.time_s
        assert not any("has changed" in said for said in page.evaluate("() => [...toasted]"))
        stored.command("set_speed", factor=0)
        told(page, "The trial is over: 0 of 3 goals reached.")
        until(page, SAYS, argument="over: 0 of 3 goals reached")
        ended = stored.state()
        assert not ended["running"]
        assert ended["time_s"] == pytest.approx(result.simulated_s)
        legend = page.evaluate("() => [...document.querySelectorAll('#timeline .mark')].map((one) => one.dataset.kind)")
        assert {"trial", "failed"} <= set(legend)


@pytest.mark.long
def test_a_stored_trial_is_opened_at_its_moment(browser, ran: tuple[Path, Ran]) -> None:
    path, (trial, result) = ran
    opened = Program(start=OPEN.format(store=str(path), id=trial.id))
    with open_page(browser, opened.url, stage=False) as page:
        until(page, SAYS, argument="8 x 8")
        state = opened.wait(lambda state: state["trial"]["ahead"] is None and state["time_s"] < result.simulated_s)
        assert state["time_s"] >= result.deciding.time_s - 10.1
        assert (state["trial"]["id"], state["trial"]["title"], state["speed"]) == (trial.id, TABLE.title, 1.0)
        told(page, "The trial is over: 0 of 3 goals reached.")
    assert opened.stop() == 0

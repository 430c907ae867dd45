"""What the gallery tells of the catalogue and of the trials that were run here."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from app.experiments.outcome import Outcome
from app.experiments.store import Store
from app.experiments.stored_trial import StoredTrial
from app.experiments.summary import summarise
from app.gallery.gallery import StoredGallery
from app.gallery.results import EARLIER, PUBLISHED, QUICK
from app.trials.chosen import chosen_trial, first_levels
from app.trials.experiment import find_experiment
from app.trials.notes import Moment
from app.trials.trial import Result, Trial
from web.http.experiments import Cell, Results

from .trials_to_watch import SHORT

TABLE = find_experiment("table")


@pytest.fixture(autouse=True)
def nothing_published(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever stands in docs/results.md today."""
    monkeypatch.setattr("app.gallery.gallery.published_cells", lambda _name: [])


def ended(trial: Trial, reached: int) -> tuple[Trial, Outcome]:
    scores = {"goals": 3.0, "reached": float(reached), "error_m": 0.1}
    moment = Moment(1250.0, "printer: reached", ok=True)
    return trial, Outcome(trial.id, Result(trial.id, scores, moment, 1320.0, 5.0, "hash"))


def trial(seed: int, levels: tuple[str, ...] = ("0 %", "64 x 64"), **changes: object) -> Trial:
    return chosen_trial(TABLE, "ours", levels, seed, **changes)  # type: ignore[arg-type]


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "experiments.sqlite")


def results(store: Store) -> Results:
    detail = StoredGallery(store.path).detail("table")
    assert detail is not None
    return detail.results


def cell(found: Results, levels: list[str], engine: str = "ours") -> Cell:
    return next(each for each in found.cells if (each.engine, each.levels) == (engine, levels))


def test_every_experiment_of_the_catalogue_has_a_card_with_a_plan(tmp_path: Path) -> None:
    path = tmp_path / "none.sqlite"
    cards = {card.name: card for card in StoredGallery(path).cards()}
    card = cards["table"]
    assert (card.engines, [axis.name for axis in card.axes]) == (["paper", "ours"], ["N_vis", "pose cells"])
    assert (card.watch, card.seed, card.trials, card.done) == (["0 %", "64 x 64"], TABLE.seed, TABLE.trials, 0)
    assert card.plan is not None
    assert len(card.plan.places) == 3
    assert card.plan.walls.startswith("M")
    assert not path.exists()  # looking makes no file


def test_without_trials_every_cell_is_there_and_empty(tmp_path: Path) -> None:
    detail = StoredGallery(tmp_path / "none.sqlite").detail("table")
    assert detail is not None
    assert len(detail.results.cells) == 2 * 6 * 4
    assert all((each.n, each.words, each.shade, each.dots) == (0, "", None, []) for each in detail.results.cells)
    assert detail.results.note == ""


def test_a_cell_is_the_rate_of_its_trials_and_each_trial_a_dot(store: Store) -> None:
    store.add([ended(trial(2), 3), ended(trial(1), 1), ended(trial(1, ("10 %", "8 x 8")), 0)])
    found = results(store)
    assert [card.done for card in StoredGallery(store.path).cards() if card.name == "table"] == [3]
    first = cell(found, ["0 %", "64 x 64"])
    assert (found.score, found.is_rate, first.n) == ("goals reached", True, 2)
    assert first.words.startswith("67 %")
    assert first.shade == pytest.approx(2 / 3)
    assert [(dot.seed, dot.good, dot.of, dot.words) for dot in first.dots] == [(1, 1, 3, "1 of 3"), (2, 3, 3, "3 of 3")]
    assert (first.dots[0].moment_s, first.dots[0].moment) == (1250.0, "printer: reached")
    assert first.dots[0].id == trial(1).id
    assert cell(found, ["10 %", "8 x 8"]).shade == 0.0
    assert cell(found, ["2 %", "64 x 64"]).n == 0


def test_short_trials_and_those_of_an_earlier_version_are_shown_only_for_want_of_better_ones(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.add([ended(trial(1, quick=True), 0)])
    assert (results(store).note, cell(results(store), ["0 %", "64 x 64"]).n) == (QUICK, 1)
    store.add([ended(trial(1), 3)])
    assert results(store).note == ""
    assert [dot.quick for dot in cell(results(store), ["0 %", "64 x 64"]).dots] == [False]
    monkeypatch.setattr("app.gallery.results.code_version", lambda: "later")
    assert results(store).note == EARLIER
    assert [dot.good for dot in cell(results(store), ["0 %", "64 x 64"]).dots] == [3]


def test_for_want_of_trials_the_programs_own_results_are_shown(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    published = summarise(
        TABLE, [StoredTrial("a", "ours", ("0 %", "64 x 64"), 1, {"goals": 3.0, "reached": 3.0}, 1.0, "")]
    )
    monkeypatch.setattr("app.gallery.gallery.published_cells", lambda _name: published)
    found = results(store)
    one = cell(found, ["0 %", "64 x 64"])
    assert (found.note, one.n, one.shade, one.dots) == (PUBLISHED, 1, 1.0, [])
    assert one.words.startswith("100 %")
    store.add([ended(trial(1), 0)])
    assert (results(store).note, cell(results(store), ["0 %", "64 x 64"]).shade) == ("", 0.0)


def test_a_trial_that_failed_is_no_dot(store: Store) -> None:
    store.add([(trial(1), Outcome(trial(1).id, None, "a fault"))])
    assert cell(results(store), ["0 %", "64 x 64"]).n == 0


def test_a_store_that_is_none_hides_no_experiment(tmp_path: Path) -> None:
    path = tmp_path / "experiments.sqlite"
    path.write_bytes(b"this is no database, but it is long enough to be taken for one" * 20)
    assert [card.done for card in StoredGallery(path).cards() if card.name == "table"] == [0]


def test_the_newest_figure_drawn_here_goes_before_that_of_the_program(tmp_path: Path) -> None:
    shipped, drawn = tmp_path / "shipped", tmp_path / "figures"
    for folder in (shipped, drawn):
        folder.mkdir()
    gallery = StoredGallery(tmp_path / "experiments.sqlite", shipped)
    assert gallery.picture("table") is None
    (shipped / "table.png").write_bytes(b"shipped")
    assert gallery.picture("table") == shipped / "table.png"
    for age_s, name in ((100, "table-1-curves.svg"), (50, "table-1-grid.svg"), (10, "table-2-maps.svg")):
        (drawn / name).write_text("drawn")
        os.utime(drawn / name, (1e9 - age_s, 1e9 - age_s))
    assert gallery.picture("table") == drawn / "table-1-grid.svg"
    assert gallery.picture("../table") is None
    assert gallery.picture("castle") is None


def test_an_experiment_that_is_not_there_has_no_detail(tmp_path: Path) -> None:
    assert StoredGallery(tmp_path / "none.sqlite").detail("castle") is None


def test_it_begins_at_the_levels_that_its_file_says() -> None:
    assert first_levels(TABLE.model_copy(update={"watch": ["10 %", "8 x 8"]})) == ("10 %", "8 x 8")
    assert first_levels(type(TABLE).model_validate(SHORT)) == ()


def test_without_a_home_the_catalogue_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/")
    monkeypatch.delenv("RATSLAM_EXPERIMENTS", raising=False)
    gallery = StoredGallery()
    assert {card.name for card in gallery.cards()} >= {"table", "loop"}
    assert gallery.picture("table")

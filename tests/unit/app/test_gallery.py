"""What the gallery tells of the catalogue and of the trials that were run here."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from app.experiments.store import Outcome, Store, StoredTrial
from app.experiments.summary import summarise
from app.gallery import EARLIER, OLDER, PUBLISHED, QUICK, StoredGallery
from app.protocol.course import Moment
from app.protocol.experiment import chosen_trial, find_experiment, first_levels
from app.protocol.trial import Result, Trial
from web.http.gallery import Card, Cell, Results

from .trials_to_watch import SHORT

TABLE = find_experiment("table")
FIRST = ("0 %", "64 x 64")


@pytest.fixture(autouse=True)
def nothing_published(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever stands in docs/results.md today."""
    monkeypatch.setattr("app.gallery.published", lambda _name: ([], []))


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "experiments.sqlite")


def trial(seed: int, levels: tuple[str, ...] = FIRST, **changes: object) -> Trial:
    return chosen_trial(TABLE, "ours", levels, seed, **changes)  # type: ignore[arg-type]


def ended(trial: Trial, reached: int) -> tuple[Trial, Outcome]:
    scores = {"goals": 3.0, "reached": float(reached), "error_m": 0.1}
    moment = Moment(1250.0, "printer: reached", ok=True)
    return trial, Outcome(trial.id, Result(trial.id, scores, moment, 1320.0, 5.0, "hash"))


def card_of(path: Path) -> Card:
    return next(card for card in StoredGallery(path).cards() if card.name == "table")


def results(path: Path) -> Results:
    detail = StoredGallery(path).detail("table")
    assert detail is not None
    return detail.results


def cell(found: Results, levels: tuple[str, ...] = FIRST) -> Cell:
    return next(each for each in found.cells if (each.engine, tuple(each.levels)) == ("ours", levels))


def test_without_trials_there_is_a_card_with_a_plan_and_every_cell_is_empty(tmp_path: Path) -> None:
    path = tmp_path / "none.sqlite"
    card, found = card_of(path), results(path)
    assert (card.engines, [axis.name for axis in card.axes]) == (["paper", "ours"], ["N_vis", "pose cells"])
    assert (card.watch, card.seed, card.trials, card.done) == ([*FIRST], TABLE.seed, TABLE.trials, 0)
    assert card.plan is not None
    assert (len(card.plan.places), card.plan.walls[0]) == (3, "M")
    assert (len(found.cells), found.note) == (2 * 6 * 4, "")
    assert all((each.n, each.words, each.shade, each.dots) == (0, "", None, []) for each in found.cells)
    assert StoredGallery(path).detail("castle") is None
    assert not path.exists(), "looking makes no file"


def test_a_cell_is_the_rate_of_its_trials_and_each_trial_a_dot(store: Store) -> None:
    store.add([ended(trial(2), 3), ended(trial(1), 1), ended(trial(1, ("10 %", "8 x 8")), 0)])
    failed = trial(1, ("2 %", "64 x 64"))
    store.add([(failed, Outcome(failed.id, None, "a fault"))])  # which is no dot
    found = results(store.path)
    first = cell(found)
    assert card_of(store.path).done == 3
    assert (found.score, found.is_rate, first.n, first.words[:4]) == ("goals reached", True, 2, "67 %")
    assert first.shade == pytest.approx(2 / 3)
    assert [(dot.seed, dot.good, dot.of, dot.words) for dot in first.dots] == [(1, 1, 3, "1 of 3"), (2, 3, 3, "3 of 3")]
    dot = first.dots[0]
    assert (dot.moment_s, dot.moment, dot.id) == (1250.0, "printer: reached", trial(1).id)
    assert cell(found, ("10 %", "8 x 8")).shade == 0.0
    assert cell(found, ("2 %", "64 x 64")).n == 0


def test_what_is_not_of_this_program_and_whole_is_shown_only_for_want_of_better(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """First the program's own results, then short trials, then those of an earlier version, then those of this one."""

    def seen() -> tuple[str, float | None, list[tuple[bool, int | None]]]:
        found = results(store.path)
        return found.note, cell(found).shade, [(dot.quick, dot.good) for dot in cell(found).dots]

    made = [StoredTrial("", "ours", FIRST, 1, {"goals": 3.0, "reached": 3.0}, 1.0, "", version="then")]
    monkeypatch.setattr("app.gallery.published", lambda _name: (summarise(TABLE, made), made))
    assert seen() == (f"{PUBLISHED} {OLDER}", 1.0, [(False, 3)])
    monkeypatch.setattr("app.gallery.published", lambda _name: (summarise(TABLE, made), []))
    assert seen() == (PUBLISHED, 1.0, [])
    assert (cell(results(store.path)).n, cell(results(store.path)).words[:5]) == (1, "100 %")
    store.add([ended(trial(1, quick=True), 0)])
    assert seen() == (QUICK, 0.0, [(True, 0)])
    store.add([ended(trial(1), 3)])
    assert seen() == ("", 1.0, [(False, 3)])
    monkeypatch.setattr("app.gallery.code_version", lambda: "later")
    assert seen() == (EARLIER, 1.0, [(False, 3)])


def test_a_store_that_is_none_hides_no_experiment(tmp_path: Path) -> None:
    path = tmp_path / "experiments.sqlite"
    path.write_bytes(b"this is no database, but it is long enough to be taken for one" * 20)
    assert card_of(path).done == 0


def test_the_newest_figure_drawn_here_goes_before_that_of_the_program(tmp_path: Path) -> None:
    shipped, drawn = tmp_path / "shipped", tmp_path / "figures"
    shipped.mkdir()
    drawn.mkdir()
    gallery = StoredGallery(tmp_path / "experiments.sqlite", shipped)
    assert gallery.picture("table") is None
    (shipped / "table.png").write_bytes(b"shipped")
    assert gallery.picture("table") == shipped / "table.png"
    for age_s, name in ((100, "table-1-curves.svg"), (50, "table-1-grid.svg"), (10, "table-2-maps.svg")):
        (drawn / name).write_text("drawn")
        os.utime(drawn / name, (1e9 - age_s, 1e9 - age_s))
    assert gallery.picture("table") == drawn / "table-1-grid.svg"
    assert [gallery.picture(name) for name in ("../table", "castle")] == [None, None]


def test_it_begins_at_the_levels_that_its_file_says() -> None:
    assert first_levels(TABLE.model_copy(update={"watch": ["10 %", "8 x 8"]})) == ("10 %", "8 x 8")
    assert first_levels(type(TABLE).model_validate(SHORT)) == ()


def test_without_a_home_the_catalogue_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/")
    monkeypatch.delenv("RATSLAM_EXPERIMENTS", raising=False)
    gallery = StoredGallery()
    assert {card.name for card in gallery.cards()} >= {"table", "loop"}
    assert gallery.picture("table")

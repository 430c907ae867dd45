"""docs/results.md is made of the numbers beside it, and these are of the experiments as they are."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from app.experiments import results
from app.experiments.results import gathered, outdated, published, read_results, results_markdown, write_results
from app.experiments.summary import leading, summarise
from app.protocol.experiment import catalogue
from tests.unit.app.made_trials import experiment, figure, trials


def test_the_results_in_the_docs_are_current():
    data, experiments = read_results(results.DOCS / "results.json"), list(catalogue())
    assert (results.DOCS / "results.md").read_text(encoding="utf-8") == results_markdown(data, experiments), (
        "run `ratslam experiment results`"
    )
    assert outdated(data, experiments) == [], "these experiments have changed: run them again, then write the results"


def test_numbers_survive_the_file(tmp_path):
    made = experiment()
    stored = trials(made)
    path, markdown = write_results([(made, stored)], tmp_path)
    text = markdown.read_text()
    assert text == results_markdown(read_results(path), [made])
    assert "NaN" not in path.read_text()
    assert "`ratslam experiment made`; seeds 10 to 13, code version v1." in text
    row = next(line for line in text.splitlines() if line.startswith("| 0 % | 8 | 4 | 81 % |"))
    assert row.count("|") == 1 + 3 + 3 + 2 + 2 + 2 + 2  # levels and n; goals with the paper's value, error, recovered
    write_results([(made, stored)], tmp_path)
    assert markdown.read_text() == text


@pytest.mark.parametrize("made", [experiment(), *catalogue()], ids=lambda made: made.name)
def test_the_trials_of_a_cell_come_to_its_leading_score(made, tmp_path):
    """Of a file that was just written and of that in the docs, whose older experiments tell no trials."""
    path = write_results([(made, trials(made))], tmp_path)[0] if made.name == "made" else results.DOCS / "results.json"
    cells, behind = published(made.name, path)
    again = {(cell.engine, cell.levels): cell for cell in summarise(made, behind)}
    assert made.name != "made" or len(again) == len(cells)
    for cell in cells:
        if now := again.get((cell.engine, cell.levels)):
            label = leading(made).label
            then = cell.values[label]
            assert (now.n, now.values[label].n) == (cell.n, then.n)
            assert now.values[label].value == pytest.approx(then.value, rel=1e-5, nan_ok=True)


def test_bad_results_are_written_too(tmp_path):
    made = experiment()
    stored = [replace(each, scores={**each.scores, "reached": 0.0}) for each in trials(made)]
    stored[0] = replace(stored[0], scores={}, error="ValueError: no room")
    text = write_results([(made, stored)], tmp_path)[1].read_text()
    assert "0 % (0-24)" in text
    assert ", 1 trials ended with an error" in text


def test_quick_trials_are_no_results():
    made = experiment()
    assert gathered([(made, [replace(each, quick=True) for each in trials(made)])]) == {"experiments": {}}
    assert results_markdown({"experiments": {}}, [made]).endswith("## Not run yet\n\nmade\n")


def test_experiments_that_were_not_run_this_time_keep_their_numbers(tmp_path):
    first, second = experiment(), experiment(name="other")
    write_results([(first, trials(first)), (second, [])], tmp_path)
    write_results([(first, []), (second, trials(second))], tmp_path)
    assert list(read_results(tmp_path / "results.json")["experiments"]) == ["made", "other"]
    write_results([(second, [])], tmp_path)
    assert list(read_results(tmp_path / "results.json")["experiments"]) == ["other"]


def test_a_change_of_what_is_run_makes_numbers_outdated():
    made = experiment()
    data = gathered([(made, trials(made))])
    assert outdated(data, [made]) == []
    for now in ([experiment(seed=11)], [experiment(axes=made.axes[:1])], []):
        assert outdated(data, now) == ["made"]
    assert outdated(data, [experiment(figures=[figure("survival", score="after")], asks="Other words?")]) == []


def test_a_score_that_nobody_has_is_no_number():
    made = experiment(trials=1)
    stored = [replace(each, scores={"error_m": 0.5}) for each in trials(made)]
    data = gathered([(made, stored)])
    values = data["experiments"]["made"]["cells"][0]["values"]
    assert values["goals reached"] == [None, 0.0, 1.0, 0]
    assert values["map error"] == [0.5, None, None, 1]
    json.dumps(data, allow_nan=False)
    assert "| - |" in results_markdown(data, [made])


def test_a_file_that_is_something_else_is_refused(tmp_path):
    path = tmp_path / "results.json"
    with pytest.raises(ValueError, match=r"results\.json"):
        read_results(path)
    path.write_text("[1]")
    with pytest.raises(ValueError, match=r'expected \{"experiments"'):
        read_results(path)

"""`ratslam deliver` and the run behind it: order, verdicts, report, and what happens when it is stopped."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.cli import command_line as cli
from app.headless import Deliveries, deliveries
from app.headless.report import MACHINE
from app.protocol.course import Course
from app.protocol.steps import order
from sim2d import load_world

LOOP = load_world("loop")
KEYS = [
    "deliveries", "succeeded", "metres", "simulated_s", "failures", "views", "experiences", "links",
    "real_time_factor", "rss_mb",
]  # fmt: skip
MORE = [
    "rss_every_s", "world", "seed", "partial", "explored", "error_m", "revisit_consistency", "revisit_share", "looks",
    "coverage", "loops", "growth", "goals", "state_hash",
]  # fmt: skip


def run(**options: Any) -> Deliveries:
    return Deliveries(LOOP, **({"seed": 4, "minutes": 1.0, "goals": 3, "deliveries": 4, "timeout_s": 200.0} | options))


@given(st.integers(2, 20), st.integers(0, 200), st.integers(0, 2**32 - 1))
def test_each_round_visits_every_goal_and_none_twice_in_a_row(goals: int, count: int, seed: int) -> None:
    numbers = list(order(goals, count, seed))
    assert len(numbers) == count
    assert numbers == list(order(goals, count, seed))
    for first in range(0, count - goals, goals):
        assert sorted(numbers[first : first + goals]) == list(range(goals))
    assert all(a != b for a, b in pairwise(numbers))


@pytest.mark.slow
def test_the_report_has_its_shape_and_the_same_run_makes_the_same_report(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.headless.report.EVERY_S", 30.0)
    monkeypatch.setattr(deliveries, "EVERY_S", 30.0)
    monkeypatch.setattr(deliveries, "HOUR_S", 60.0)
    reports: list[dict[str, Any]] = []
    for _ in range(2):
        told: list[str] = []
        deliver = run(progress=lambda _s, what, told=told: told.append(what))
        deliver.carry_out()
        reports.append(deliver.report())
        assert told[0] == "exploring"
        assert told[-1].startswith("delivery 4 of 4, ")
    report = reports[0]
    assert list(report) == KEYS + MORE
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert report["deliveries"] == 4
    assert report["succeeded"] + len(report["failures"]) == 4
    assert sum(goal["visits"] for goal in report["goals"]) == 4
    assert not report["partial"]
    assert len(report["rss_mb"]) == report["simulated_s"] // 30
    assert [row["at_s"] for row in report["growth"][:-1]] == [60.0 * (k + 1) for k in range(len(report["growth"]) - 1)]
    assert report["growth"][-1]["at_s"] == report["simulated_s"]
    assert report["growth"][-1]["views"] == report["views"]
    assert report["explored"]["simulated_s"] == 60.0
    assert _same(reports[0]) == _same(reports[1])


def _same(report: dict[str, Any]) -> dict[str, Any]:
    growth = [{key: value for key, value in row.items() if key not in MACHINE} for row in report["growth"]]
    return {key: value for key, value in report.items() if key not in MACHINE} | {"growth": growth}


@pytest.mark.slow
def test_a_delivery_that_takes_too_long_is_a_failure() -> None:
    late = run(timeout_s=0.5, deliveries=2)
    late.carry_out()
    failures = late.report()["failures"]
    assert [failure["reason"].split(":")[0] for failure in failures] == ["not reached in 0.5 s"] * 2
    assert [list(failure) for failure in failures] == [["at_s", "goal", "reason"]] * 2
    assert failures[0]["at_s"] == 60.0
    assert failures[1]["at_s"] == pytest.approx(60.5)


def test_too_few_places_are_a_sentence() -> None:
    words = r"goals = 50, but the robot knows only \d+ places; let it explore"
    with pytest.raises(ValueError, match=words):
        run(goals=50, minutes=0.1).carry_out()


@pytest.mark.slow
def test_control_c_leaves_the_report_of_what_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    go, done = Course.go, []

    def interrupted(*arguments: Any) -> Iterator[str]:
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(1)
        return go(*arguments)

    monkeypatch.setattr(Course, "go", interrupted)
    file = tmp_path / "report.json"
    command = ["deliver", "--world", "loop", "--minutes", "1", "--goals", "2", "--deliveries", "9", "--timeout", "20"]
    assert cli.main([*command, "--report", str(file)]) == 130
    report = json.loads(file.read_text("utf-8"))
    assert report["partial"]
    assert report["deliveries"] == 2
    assert (
        f"loop, seed 1: stopped early, after 2 of 9 deliveries: {report['succeeded']} of 2" in capsys.readouterr().out
    )


@pytest.mark.slow
def test_deliver_prints_its_report(capsys: pytest.CaptureFixture[str]) -> None:
    command = ["deliver", "--world", "loop", "--minutes", "0.5", "--goals", "2", "--deliveries", "1", "--timeout", "5"]
    assert cli.main(command) == 0
    assert json.loads(capsys.readouterr().out)["deliveries"] == 1


def test_what_cannot_be_is_a_sentence(capsys: pytest.CaptureFixture[str], subtests: pytest.Subtests) -> None:
    for option, value, sentence in (
        ("--goals", "1", "--goals must be from 2 to 1000, got 1; a delivery leads from one place to another"),
        ("--deliveries", "0", "--deliveries must be from 1 to 1e+06, got 0; "),
        ("--minutes", "0", "--minutes must be from 0.1 to 1e+06, got 0; the robot must have seen the places"),
        ("--timeout", "nan", "--timeout must be from 1 to 1e+06, got nan; "),
        ("--world", "castle", "no world 'castle'; expected one of: office"),
        ("--report", "/nowhere/at/all.json", "there is no folder"),
    ):
        with subtests.test(msg=sentence):
            assert cli.main(["deliver", option, value]) == 2
            out, err = capsys.readouterr()
            assert (out, err[:9], err.count("\n"), sentence in err) == ("", "ratslam: ", 1, True)

"""The rows of the bars: which runs they are made of, what is judged, what is printed and written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.back_end.cities import manhattan
from benchmarks.true_map import __main__ as command
from benchmarks.true_map import figures, jobs, local
from benchmarks.true_map.figures import Figure
from benchmarks.true_map.jobs import Job, words_of_time
from benchmarks.true_map.rows import PLANS, ROWS, STEADY, Options

NOWHERE = Path("/nowhere")


def planned(name: str, **options: Any) -> list[Job]:
    return ROWS[name].planned(Options(NOWHERE, **options))


def test_options_choose_seeds_worlds_and_parameters() -> None:
    some = planned("halls", seeds=(3, 4), worlds=("campus",), values={"pilot.cruise_speed": 0.3})
    assert [(job.name, job.seed, job.values["pilot.cruise_speed"]) for job in some] == [
        ("campus", 3, 0.3), ("campus", 4, 0.3),
    ]  # fmt: skip
    assert planned("deliveries", deliveries=60)[0].deliveries == 60
    on, off = planned("living", seeds=(1,), values={"robot.light": 0.5})
    assert (on.variant, off.variant, off.values) == ("", "off", {"robot.light": 0.5} | STEADY)


def test_a_hundred_kidnaps_in_ten_worlds_beside_runs_without() -> None:
    for seeds in ((1,), (1, 2, 3), (1, 2, 3, 4)):
        runs = planned("kidnaps", seeds=seeds)
        carried, left = ([job for job in runs if job.variant == variant] for variant in ("", "without"))
        assert [sum(job.kidnaps for job in some) for some in (carried, left)] == [100, 0]
        assert [(job.name, job.seed) for job in carried] == [(job.name, job.seed) for job in left]


def test_plans_that_are_there_are_run(tmp_path: Path) -> None:
    assert planned("plans") == []
    file = tmp_path / PLANS["willow"][0]
    file.parent.mkdir(parents=True)
    file.write_bytes(b"")
    runs = ROWS["plans"].planned(Options(tmp_path, seeds=(1, 2)))
    assert [(job.name, job.world, job.scale_m) for job in runs] == [("willow", str(file), 0.1)] * 2


def report(**more: Any) -> dict[str, Any]:
    goals = [{"reached": True, "miss_m": 0.1}] * 5
    about = {
        "name": "office", "seed": 1, "variant": "", "error": None, "error_m": {"map": 0.1}, "goals": goals,
        "loops": {"closed": 1, "of": 1}, "revisit_share": 0.3, "kidnaps": [], "real_time_factor": 300.0,
    }  # fmt: skip
    return about | more


def verdicts(name: str, runs: list[dict[str, Any]]) -> dict[str, Figure]:
    return {figure.what: figure for figure in ROWS[name].judge(runs)}


def test_median_worst_goals_and_miss() -> None:
    found = verdicts("office", [report(error_m={"map": error}) for error in (0.1, 0.12, 0.3)])
    assert [(f.value, f.holds) for f in found.values()] == [(0.12, True), (0.3, False), (15, True), (0.1, True)]
    assert found["goals"].words == "15 of 15"
    missed = report(goals=[{"reached": False, "miss_m": 2.0}] + 4 * [{"reached": True, "miss_m": 0.1}])
    assert not verdicts("office", [missed])["goals"].holds
    assert verdicts("twins", [missed, *[report()] * 9])["goals"].holds  # 49 of 50
    assert not verdicts("twins", [missed] * 10)["goals"].holds


def test_a_run_that_failed_misses_every_bar() -> None:
    failed = {"name": "office", "seed": 1, "variant": "", "error": "ValueError: no"}
    for name in ("office", "twins", "living", "halls", "suburb", "wheels"):
        found = verdicts(name, [report(), failed, report(variant="off")])
        assert not next(f for what, f in found.items() if what.endswith("worst")).holds
    assert not verdicts("office", [failed])["goals"].holds
    assert list(ROWS["deliveries"].judge([failed])) == []


def test_living_is_judged_beside_everything_off() -> None:
    off = report(variant="off", revisit_share=0.4, error_m={"map": 9.0})
    found = verdicts("living", [report(revisit_share=0.2), off])
    assert (found["map error, worst"].value, found["goals"].words) == (0.1, "5 of 5")
    old = found["ticks on an old experience, on / off"]
    assert (old.value, old.holds) == (0.5, False)


def test_the_loop_of_the_corridors_has_to_be_closed_in_every_run() -> None:
    closed, open_ = report(name="corridors"), report(name="corridors", loops={"closed": 0, "of": 1})
    assert verdicts("halls", [closed, report(loops={"closed": 0, "of": 6})])["corridors: loop closed"].holds
    assert not verdicts("halls", [closed, open_])["corridors: loop closed"].holds


def test_kidnaps_and_what_they_cost() -> None:
    again, without = {"recovered": True, "after_s": 4.0, "met_s": 0.0}, report(variant="without")
    lost = {"recovered": False, "after_s": None, "met_s": None}
    found = verdicts("kidnaps", [report(kidnaps=[again] * 97 + [lost] * 3, error_m={"map": 0.11}), without])
    assert found["kidnaps recovered"].words == "97 of 100"
    assert found["in two minutes, of those that met known ground"].words == "97 of 97"
    assert all(f.holds for f in found.values() if f.bar)
    found = verdicts("kidnaps", [report(kidnaps=[again], error_m={"map": 0.2}), without])
    assert not found["map error / without, worst"].holds


def test_the_last_hour_is_held_against_the_second() -> None:
    def hour(at_s: float, size: float) -> dict[str, Any]:
        grown = dict.fromkeys(("views", "experiences", "links", "view_links", "rss_mb"), size)
        return {"at_s": at_s, **grown, "real_time_factor": 200.0}

    first = [hour(3600.0, 50), hour(7200.0, 100)]
    found = list(figures.hours([*first, hour(10800.0, 105), hour(11000.0, 999)]))
    assert [(f.value, f.holds) for f in found] == [(1.05, True)] * 5 + [(1.0, True)]
    assert not next(iter(figures.hours([*first, hour(10800.0, 120)]))).holds
    assert [f.holds for f in figures.hours(first)] == [None]


def test_speed_is_judged_at_both_ends() -> None:
    grown = [{"views": 1, "experiences": 2, "links": 3, "view_links": 4}]
    run = report(real_time_factors=[600.0] * 4 + [500.0] + [300.0] * 4, growth=grown)
    assert [f.holds for f in figures.speeds([run])] == [True, False, None]


def test_how_long_it_will_take_is_said_before() -> None:
    assert words_of_time(planned("office"), 2).startswith("10 runs, 3.9 simulated h: about ")
    one, many = (words_of_time(planned("suburb"), workers) for workers in (1, 8))
    assert one.partition(" with")[0] == many.partition(" with")[0]  # one run has one worker


def test_a_run_is_a_headless_run_or_deliveries() -> None:
    done = jobs.run(Job(row="office", world="loop", name="loop", seed=2, minutes=1.0, goals=1, kidnaps=1))
    assert (done["error"], done["seed"], len(done["goals"]), len(done["kidnaps"])) == (None, 2, 1, 1)
    failed = jobs.run(Job(row="x", world="castle", name="castle", seed=1, minutes=1.0))
    assert failed["error"].startswith("WorldError: no world")
    delivered = jobs.run(Job(row="x", world="loop", name="loop", seed=2, minutes=0.5, goals=2, deliveries=1))
    assert delivered["deliveries"] == 1


def test_graphs_with_lies_are_judged_with_true_and_with_usual_claims(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local, "graphs", lambda _data: iter([manhattan(120)]))
    found = list(local.ROWS["back-end"][1](NOWHERE))
    assert [f.what for f in found] == [
        f"Manhattan, {claims}: {what}" for claims in ("true claims", "claiming 0.15 m") for what in ("off", "time")
    ]
    assert [f.bar for f in found] == 2 * ["<= 0.1 m", "<= 0.5 s"]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs, "run", lambda job: report(name=job.name, seed=job.seed, variant=job.variant))
    monkeypatch.setattr(local, "ROWS", {"step": ("a step", lambda _data: iter([Figure("step", 1.0, "1.00 ms")]))})


@pytest.mark.usefixtures("quick")
def test_figures_are_printed_beside_their_bars_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bars.json"
    assert command.main(["office", "step", "--seeds", "1", "2", "--workers", "1", "--report", str(file)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith("office: 20 min and 5 goals; 2 runs, 0.8 simulated h: about ")
    assert out[1:3] == [
        f"  {seed} of 2: office, seed {seed}: map 0.1 m, 5 of 5 goals; 300 x real time" for seed in (1, 2)
    ]
    assert out[3].split() == ["office", "map", "error,", "median", "0.10", "m", "bar", "<=", "0.15", "m", "holds"]
    assert out[-1].split() == ["step", "step", "1.00", "ms"]
    told = json.loads(file.read_text("utf-8"))
    assert [row["row"] for row in told] == ["office", "step"]
    assert [run["seed"] for run in told[0]["runs"]] == [1, 2]
    assert told[0]["figures"][0] == {
        "what": "map error, median", "value": 0.1, "words": "0.10 m", "bar": "<= 0.15 m", "holds": True,
    }  # fmt: skip


@pytest.mark.usefixtures("quick")
def test_what_is_not_there_is_skipped_with_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    for words, sentence in (
        (["plans", "--data", "/nowhere"], "no floor plans are in /nowhere; give their folder with --data"),
        (["office", "--worlds", "campus"], "office: skipped, there is nothing to run: it has no world named campus"),
    ):
        assert command.main(words) == 0
        assert sentence in capsys.readouterr().out


@pytest.mark.usefixtures("quick")
def test_control_c_ends_with_the_figures_of_what_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run(job: Job) -> dict[str, Any]:
        if job.seed == 3:
            raise KeyboardInterrupt
        return report(seed=job.seed)

    monkeypatch.setattr(jobs, "run", run)
    file = tmp_path / "bars.json"
    assert command.main(["office", "twins", "--seeds", "1", "2", "3", "--workers", "1", "--report", str(file)]) == 130
    assert "office: stopped after 2 of 3 runs; their figures:" in capsys.readouterr().out
    told = json.loads(file.read_text("utf-8"))
    assert [(row["row"], row["partial"], len(row["runs"])) for row in told] == [("office", True, 2)]


def test_what_cannot_be_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for wrong in (
        "castle", "office --workers 0", "--seeds 1 1", "--report /nowhere/at/all.json", "--set robot.lihgt=1", "--set x",
        "--worlds x", "--deliveries 0",
    ):  # fmt: skip
        with pytest.raises(SystemExit) as end:
            command.main(wrong.split())
        assert end.value.code == 2
        assert "error: " in capsys.readouterr().err, wrong

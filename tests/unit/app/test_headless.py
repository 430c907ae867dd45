from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.config import Config
from app.evaluation import Evaluation
from app.headless import BrainFile, run_headless
from app.headless.report import Growth
from disk import state_codec
from ratslam_core import load_brain
from sim2d import load_world

from .sessions import OFFICE, a_session

pytestmark = pytest.mark.slow

KEYS = [
    "world", "seed", "simulated_s", "wall_s", "real_time_factor", "ticks", "metres", "views", "false_positives",
    "experiences", "links", "view_links", "let_go", "relocalisations", "error_m", "revisit_consistency",
    "revisit_share", "looks", "coverage", "loops", "uncertainty", "growth", "real_time_factors", "rss_mb", "goals",
    "kidnaps", "state_hash",
]  # fmt: skip
GOAL_KEYS = ["experience", "reached", "time_s", "path_m", "shortest_m", "miss_m", "reason"]


def test_the_report_has_its_shape() -> None:
    told: list[tuple[float, str]] = []
    report = run_headless(OFFICE, 2, 0.5, goals=2, kidnap_at_s=[20, 5], progress=lambda s, what: told.append((s, what)))
    assert list(report) == KEYS
    assert list(report["error_m"]) == ["map", "odometry"]
    assert list(report["revisit_consistency"]) == ["within_half_metre"]
    assert [list(goal) for goal in report["goals"]] == [GOAL_KEYS] * 2
    assert [list(kidnap) for kidnap in report["kidnaps"]] == [["at_s", "recovered", "after_s", "after_m", "met_s"]] * 2
    assert [kidnap["at_s"] for kidnap in report["kidnaps"]] == [5.0, 20.0]
    assert (report["world"], report["seed"]) == ("office", 2)
    assert report["ticks"] == round(report["simulated_s"] * 10) >= 300
    assert report["simulated_s"] == pytest.approx(30 + sum(goal["time_s"] for goal in report["goals"]))
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert sum(s for s, _ in told) == pytest.approx(report["simulated_s"], abs=2.0)
    assert list(dict.fromkeys(what for _, what in told)) == [
        "exploring",
        *(f"on the way to goal {n} of 2" for n in (1, 2)),
    ]
    for goal in report["goals"]:
        assert isinstance(goal["reached"], bool)
        assert goal["path_m"] >= 0
        assert not goal["reached"] or goal["miss_m"] <= 1.0


def test_headless_is_the_session_and_nothing_else_and_its_growth_is_sampled_at_regular_times(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("app.headless.report.EVERY_S", 6.0)
    report, session = run_headless(OFFICE, 4, 0.3), a_session(180, seed=4)
    map_ = session.brain.experience_map
    found = {name: report[name] for name in ("state_hash", "goals", "kidnaps", "views", "experiences", "links")}
    assert found == {
        "state_hash": session.state_hash(), "goals": [], "kidnaps": [],
        "views": len(session.brain.local_view), "experiences": len(map_), "links": map_.link_count,
    }  # fmt: skip
    assert report["false_positives"] == 0
    assert [row["at_s"] for row in report["growth"]] == [6.0, 12.0, 18.0]
    assert len(report["rss_mb"]) == len(report["real_time_factors"]) == 3
    for name in ("views", "experiences", "links", "view_links"):
        counts = [row[name] for row in report["growth"]]
        assert counts == sorted(counts)
        assert name == "view_links" or counts[-1] == report[name]


def test_nothing_simulated_is_a_report_too() -> None:
    report = run_headless(OFFICE, 1, 0.0)
    assert (report["ticks"], report["experiences"], report["simulated_s"]) == (0, 1, 0.0)
    assert report["error_m"] == {"map": 0.0, "odometry": 0.0}
    assert report["revisit_consistency"] == {"within_half_metre": None}
    json.dumps(report, allow_nan=False)


def test_memory_is_that_of_the_process_without_the_judges_record(monkeypatch: pytest.MonkeyPatch) -> None:
    session = a_session()
    before = Growth(session).sample().rss_mb
    record = np.ones(30_000_000)  # 240 MB
    during = Growth(session).sample().rss_mb
    monkeypatch.setattr(Evaluation, "memory_bytes", record.nbytes)  # as if the judge kept that
    without = Growth(session).sample().rss_mb
    if before is not None and during is not None and without is not None:  # on Linux
        assert (during - before, without - before) == (pytest.approx(240, abs=30), pytest.approx(0, abs=30))


def test_what_is_judged_lies_within_its_bounds() -> None:
    report = run_headless(load_world("loop"), 3, 1.5)
    looks, sure, loops = report["looks"], report["uncertainty"], report["loops"]
    assert 0.2 < report["coverage"] <= 1.0
    assert 0.0 <= report["revisit_share"] <= 1.0
    assert 0 <= loops["closed"] <= loops["of"] == 1
    assert 0 <= looks["false_believed"] <= looks["false"] <= looks["all"]
    assert 0 < sure["median_m"] <= sure["most_m"]
    assert 0 <= sure["within_two_sigma"] <= 1
    assert sure["lost_share"] == 0.0


def test_a_belief_without_a_sigma_has_no_uncertainty() -> None:
    sure = run_headless(OFFICE, 4, 0.1, config=Config().with_value("experience_map.anchor_sigma", 0.0))["uncertainty"]
    assert (sure["median_m"], sure["most_m"], sure["within_two_sigma"]) == (None, None, None)


def test_a_goal_that_is_not_reached_in_time_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.headless.run.GOAL_PATIENCE_S", 2.0)
    monkeypatch.setattr("app.headless.run.GOAL_SPEED", 1e9)
    (goal,) = run_headless(OFFICE, 2, 0.7, goals=1)["goals"]
    assert (goal["reached"], goal["time_s"]) == (False, pytest.approx(2.0, abs=0.15))
    assert goal["miss_m"] > 0.3


def test_a_brain_that_grows_too_large_for_a_file_is_told_of_in_time(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(BrainFile, "LOOK_AFTER", 10)
    monkeypatch.setattr(state_codec, "MOST_BYTES", 1 << 20)
    run_headless(OFFICE, 2, 0.1)
    assert capsys.readouterr().err == ""
    run_headless(OFFICE, 2, 0.1, brain_file=BrainFile(tmp_path / "brain.npz"))
    words = "ratslam: note: the brain fills more than half of the 1 MiB that a file may hold: save it before it grows\n"
    assert capsys.readouterr().err == words  # once


def test_a_saved_brain_finds_its_way_again(tmp_path: Path) -> None:
    brain_file = BrainFile(tmp_path / "brain.npz")
    run_headless(OFFICE, 4, 8.0, brain_file=brain_file)
    brain_file.save()
    brain = load_brain(tmp_path / "brain.npz")
    known = len(brain.experience_map)
    goals = run_headless(OFFICE, 12, 2.0, brain=brain, goals=3)["goals"]
    assert any(goal["experience"] < known for goal in goals)  # places where this robot has never been
    assert all(goal["reached"] for goal in goals)

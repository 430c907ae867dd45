"""A session that is killed loses no more than the time since its brain was kept."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from app.kept_brains import newest
from tests.e2e.program import START, Program
from tests.patience import PATIENCE_S, until

OFTEN, SELDOM = (f"import app.kept_brains as keeper; keeper.EVERY_S = {every}; {START}" for every in (0.2, 1e6))


def kept() -> tuple[str, float]:
    """World and simulated time of the newest brain."""
    found = newest()
    return (found.about.world, found.about.time_s) if found else ("", 0.0)


def test_after_a_kill_the_brain_is_offered_and_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_BRAINS", str(tmp_path))
    paused = {"start": SELDOM, "RATSLAM_BRAINS": str(tmp_path)}
    first = Program("--port", "0", "--seed", "7", "--world", "loop", "--paused", **{**paused, "start": OFTEN})
    try:
        assert not any("a brain of" in line for line in first.said)
        first.command("step", ticks=700)
        known = first.state()["experiences"]
        until(lambda: kept() == ("loop", 70.0), "a brain of the loop")
    finally:
        first.process.kill()
        first.stop()
    second = Program("--port", "0", "--paused", "--resume-brain", **paused)
    try:
        state = second.state()
        assert (state["world"], state["seed"], state["tick"]) == ("loop", 7, 0)
        assert state["experiences"] >= known > 100
    finally:
        assert second.stop() == 0
    third = Program("--port", "0", "--paused", **paused)
    try:
        offered = next(line for line in third.said if "a brain of" in line)
        assert f"There is a brain of loop, seed 7, 1 min, {known} experiences, kept " in offered
        assert "`ratslam run --resume-brain`" in offered
        assert third.state()["world"] == "office"
        assert (kept(), len(list(tmp_path.glob("*.npz")))) == (("loop", 70.0), 1)  # who did nothing has left nothing
        third.command("step", ticks=650)
        third.process.send_signal(signal.SIGTERM)
        third.process.wait(timeout=PATIENCE_S)
    finally:
        assert third.stop() == 0
    assert (kept(), len(list(tmp_path.glob("*.npz")))) == (("office", 65.0), 2)

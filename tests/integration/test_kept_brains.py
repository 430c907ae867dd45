"""A session that ends leaves its brain, and one that is killed loses no more than the time since its brain was kept."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from app.run_record.folder import STATE
from app.run_record.states import newest_brain
from tests.e2e.program import START, Program
from tests.patience import PATIENCE_S

OFTEN = (
    "import app.run_record.states as states, app.run_record.writer as writer; "
    f"states.SAVE_PAUSE_S = 0.0; states.SAVE_SHARE = writer.COPY_SHARE = 1e9; {START}"
)


def kept() -> tuple[str, float]:
    """World and simulated time of the newest brain."""
    found = newest_brain()
    return (found.about.world, found.about.time_s) if found else ("", 0.0)


def test_after_a_kill_the_brain_is_offered_and_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    first = Program(
        "--port", "0", "--seed", "7", "--world", "loop", "--paused", start=OFTEN, RATSLAM_RUNS=str(tmp_path)
    )
    try:
        assert not any("a brain of" in line for line in first.said)
        first.command("step", ticks=500)
        while kept()[0] != "loop":
            first.command("step", ticks=100)
    finally:
        first.process.kill()
        first.stop()
    brain = newest_brain()
    assert brain is not None
    assert (brain.about.seed, brain.about.time_s >= 60.0) == (7, True)
    known = brain.about.experiences
    second = Program("--port", "0", "--paused", "--resume-brain", RATSLAM_RUNS=str(tmp_path))
    try:
        state = second.state()
        assert (state["world"], state["seed"], state["tick"]) == ("loop", 7, 0)
        assert state["experiences"] >= known > 50
    finally:
        assert second.stop() == 0
    third = Program("--port", "0", "--paused", RATSLAM_RUNS=str(tmp_path))
    try:
        offered = next(line for line in third.said if "a brain of" in line)
        assert f"There is {brain.words}" in offered
        assert "`ratslam run --resume-brain`" in offered
        assert third.state()["world"] == "office"
        assert (newest_brain(), len(list(tmp_path.glob(f"*/{STATE}")))) == (
            brain,
            1,
        )  # who did nothing has left nothing
        third.command("step", ticks=655)
        third.process.send_signal(signal.SIGTERM)
        third.process.wait(timeout=PATIENCE_S)
    finally:
        assert third.stop() == 0
    assert (kept(), len(list(tmp_path.glob(f"*/{STATE}")))) == (("office", 65.5), 2)

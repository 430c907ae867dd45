"""A session that is killed loses no more than the time since its brain was kept."""

from __future__ import annotations

import contextlib
import signal
import time
import urllib.error
from pathlib import Path
from typing import Any

from app.kept_brains.files import _read
from tests.e2e.program import START, Program
from tests.patience import PATIENCE_S

OFTEN = "import app.kept_brains.keeper as keeper; keeper.EVERY_S = 0.2; " + START
SELDOM = "import app.kept_brains.keeper as keeper; keeper.EVERY_S = 1e6; " + START


def first_state(program: Program) -> dict[str, Any]:
    """The first state of a program whose engine may still be starting."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        with contextlib.suppress(urllib.error.HTTPError):
            return program.state()
        time.sleep(0.05)
    raise AssertionError("no state")


def times(folder: Path) -> list[tuple[str, float]]:
    """World and simulated time of all brains that are kept, in the order in which they were."""
    kept = [found.about for path in folder.glob("*.npz") if (found := _read(path)) is not None]
    return [(about.world, about.time_s) for about in sorted(kept, key=lambda about: about.kept_at)]


def wait_until_kept(folder: Path, world: str, time_s: float) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while (world, time_s) not in times(folder):
        assert time.monotonic() < deadline, times(folder)
        time.sleep(0.05)


def test_after_a_kill_the_brain_is_offered_and_used(tmp_path: Path) -> None:
    first = Program(
        "--port", "0", "--seed", "7", "--world", "loop", "--paused", start=OFTEN, RATSLAM_BRAINS=str(tmp_path)
    )
    try:
        assert not any("a brain of" in line for line in first.said)
        first_state(first)
        first.command("step", ticks=700)
        known = first.state()["experiences"]
        wait_until_kept(tmp_path, "loop", 70.0)
    finally:
        first.process.kill()
        first.process.wait(timeout=PATIENCE_S)
    second = Program("--port", "0", "--paused", "--resume-brain", start=SELDOM, RATSLAM_BRAINS=str(tmp_path))
    try:
        state = first_state(second)
        assert (state["world"], state["seed"]) == ("loop", 7)
        assert state["experiences"] >= known > 100
        assert state["tick"] == 0
    finally:
        assert second.stop() == 0
    third = Program("--port", "0", "--paused", start=SELDOM, RATSLAM_BRAINS=str(tmp_path))
    try:
        offered = next(line for line in third.said if "a brain of" in line)
        assert f"There is a brain of loop, seed 7, 1 min, {known} experiences, kept " in offered
        assert "`ratslam run --resume-brain`" in offered
        assert first_state(third)["world"] == "office"
        assert len(list(tmp_path.glob("*.npz"))) == 1  # the two programs that did nothing have left nothing
        third.command("step", ticks=650)
        third.process.send_signal(signal.SIGTERM)
        third.process.wait(timeout=PATIENCE_S)
        assert third.process.returncode == 0
    finally:
        third.process.kill()
        third._brains.cleanup()
    assert times(tmp_path) == [("loop", 70.0), ("office", 65.0)]

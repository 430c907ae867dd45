"""A program that is killed loses no more of its run than half a second, and the next one goes on with it, bit for bit."""

from __future__ import annotations

import json
import random
import time
import urllib.request
from pathlib import Path

import pytest

from app.run_record.folder import LINES, all_runs
from app.run_record.reader import open_run
from app.run_record.resume import replayed
from tests.e2e.program import Program
from tests.patience import PATIENCE_S, until


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("RATSLAM_RUNS", str(tmp_path))
    return str(tmp_path)


def tick_in(name: str) -> int:
    """The last tick of a run that is being written, -1 as long as its first line is not whole."""
    try:
        return open_run(name).tick
    except ValueError:
        return -1


@pytest.mark.slow
def test_after_a_kill_the_run_is_offered_and_goes_on(home: str) -> None:
    program = Program("--port", "0", "--seed", "7", "--world", "loop", "--paused", RATSLAM_RUNS=home)
    try:
        program.command("step", ticks=120)
        program.command("kidnap")
        program.command("step", ticks=7)
        until(lambda: all_runs() and tick_in("last") >= 127, "tick 127 in its file")
    finally:
        program.process.kill()
        program.stop()
    run = open_run("last")
    assert (run.tick, [order.name for order in run.orders], run.end) == (127, ["kidnap"], "")
    there = replayed(run)
    for resume in (("--resume", run.name), ()):
        program = Program("--port", "0", "--paused", *resume, RATSLAM_RUNS=home)
        try:
            if not resume:
                assert any(f"`ratslam run --resume {run.name}`" in line for line in program.said)
                assert program.state()["world"] == "office"
                with urllib.request.urlopen(f"{program.url}api/brain/kept", timeout=PATIENCE_S) as answer:
                    assert json.load(answer)["run"] == run.name
                assert program.post("brain/kept", {"use": True}) == {"used": True}
            state = program.state()
            assert (state["world"], state["seed"], state["tick"]) == ("loop", 7, there.tick_count)
            assert state["experiences"] == len(there.brain.experience_map)
            program.command("step", ticks=5)
            for _ in range(5):
                there.tick()
            if resume:  # it is killed, too, but only once its ticks are kept
                until(lambda: tick_in(run.name) >= 132, "tick 132 in its file")
        finally:
            if resume:
                program.process.kill()
            program.stop()
    whole = open_run(run.name)
    assert (whole.tick, len(whole.again), whole.end, whole.damage) == (137, 2, "the program ended", "")
    assert replayed(whole).state_hash() == there.state_hash()


@pytest.mark.long
def test_killed_at_any_moment_it_opens_and_comes_out_the_same(home: str) -> None:
    program = Program("--port", "0", "--speed", "0", "--world", "loop", RATSLAM_RUNS=home)
    time.sleep(random.Random(5).uniform(0.5, 3.0))
    program.process.kill()
    program.stop()
    if all_runs():  # else its file was not begun
        run = open_run("last")
        assert (run.folder / LINES).stat().st_size >= run.size
        assert replayed(run).tick_count == run.tick

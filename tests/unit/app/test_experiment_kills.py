"""kill -9 of the client and of workers at fifty random moments: no score is lost, none is counted twice."""

from __future__ import annotations

import os
import random
import signal
import time
from pathlib import Path

import psutil
import pytest

from app.experiments.store import Store
from tests.unit.app import fake_trials
from tests.unit.app.test_experiment_runner import PATIENCE_S, assert_all_right, begin

KILLS = 50
CLIENTS = 8  # of them; it takes longer until a client is at work again
TRIALS = 2500
MOST_WAIT_S = 0.6


@pytest.mark.slow
def test_fifty_kills_lose_nothing(tmp_path: Path) -> None:
    rng, path = random.Random(12), tmp_path / "trials.sqlite"
    victims = ["client"] * CLIENTS + ["worker"] * (KILLS - CLIENTS)
    rng.shuffle(victims)
    command, killed = begin(path, TRIALS), 0
    with Store(path) as store:
        for victim in victims:
            before, until = len(store.of_experiment("small")), time.monotonic() + PATIENCE_S
            if rng.random() < 0.7:  # else at any moment, also while it begins
                more = rng.randint(1, 30)
                while len(store.of_experiment("small")) < before + more and command.poll() is None:
                    assert time.monotonic() < until, f"stands still after {killed} kills"
                    time.sleep(0.01)
            time.sleep(rng.uniform(0.0, MOST_WAIT_S))
            if command.poll() is not None:  # all was done: there is more to do in a longer run
                break
            pid = command.pid if victim == "client" else worker_of(command.pid, rng)
            if pid is not None:
                os.kill(pid, signal.SIGKILL)
                killed += 1
            if victim == "client":
                command.wait()
                command = begin(path, TRIALS)
        command.wait(PATIENCE_S)
        for _ in range(3):  # a trial whose worker died four times has failed, and is run by the next command
            assert begin(path, TRIALS).wait(PATIENCE_S) == 0
        assert_all_right(store, fake_trials.trials(TRIALS))
        assert killed >= KILLS - CLIENTS


def worker_of(client: int, rng: random.Random) -> int | None:
    """One of the client's workers: they are forked by a child of the client. None while there is none."""
    try:
        children = psutil.Process(client).children()
        workers = [worker.pid for child in children for worker in child.children()]
    except psutil.NoSuchProcess:
        return None
    return rng.choice(sorted(workers)) if workers else None

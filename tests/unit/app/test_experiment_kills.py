"""kill -9 of the client and of workers at fifty random moments: no score is lost, none is counted twice."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import sqlite3
import subprocess
import time
from functools import partial
from pathlib import Path

import psutil
import pytest

from app.experiments.store import Store
from tests.unit.app import fake_trials
from tests.unit.app.test_experiment_runner import PATIENCE_S, assert_all_right, begin, wait_until

KILLS = 50
CLIENTS = 8  # of them; it takes longer until a client is at work again
MORE = 2000  # trials at first, and whenever all are done
MOST_WAIT_S = 0.2


@pytest.mark.long
def test_fifty_kills_lose_nothing(tmp_path: Path) -> None:
    rng, path, total = random.Random(12), tmp_path / "trials.sqlite", MORE
    victims = ["client"] * CLIENTS + ["worker"] * (KILLS - CLIENTS)
    rng.shuffle(victims)
    command = begin(path, total)
    with Store(path) as store:
        for victim in victims:
            if rng.random() < 0.7:  # else at any moment, also while it begins
                wanted = kept_by(store) + rng.randint(1, 30)
                wait_until(partial(_has_done, store, wanted, command), "there are more")
            time.sleep(rng.uniform(0.0, MOST_WAIT_S))
            while (pid := command.pid if victim == "client" else worker_of(command.pid, rng)) is None or dead(command):
                if dead(command):
                    assert command.returncode == 0, command.communicate()[1]
                    total += MORE  # it has done all: there shall be more
                    command = begin(path, total)
                time.sleep(0.01)
            os.kill(pid, signal.SIGKILL)
            if victim == "client":
                command.wait()
                command = begin(path, total)
        command.wait(4 * PATIENCE_S)  # on a busy machine thousands of trials are still to come
        for _ in range(2):  # a trial whose worker died four times has failed, and is run by the next command
            with begin(path, total) as again:
                assert again.wait(PATIENCE_S) == 0
        assert_all_right(store, fake_trials.trials(total))


def kept_by(store: Store) -> int:
    with contextlib.closing(sqlite3.connect(store.path)) as db:  # looked at often: no more than counted
        return db.execute("SELECT count(*) FROM trials").fetchone()[0]


def _has_done(store: Store, wanted: int, command: subprocess.Popen[str]) -> bool:
    return kept_by(store) >= wanted or dead(command)


def dead(command: subprocess.Popen[str]) -> bool:
    return command.poll() is not None


def worker_of(client: int, rng: random.Random) -> int | None:
    """One of the client's workers: they are forked by a child of the client. None while there is none."""
    try:
        children = psutil.Process(client).children()
        workers = [
            worker.pid for child in children for worker in child.children() if worker.status() != psutil.STATUS_ZOMBIE
        ]
    except psutil.NoSuchProcess:
        return None
    return rng.choice(sorted(workers)) if workers else None

"""Many trials on Dask's workers: each runs once, whatever happens to a worker; nothing is left behind when the client ends."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import dask
import psutil
import pytest
from distributed import Client
from distributed.security import Security

from app.experiments.pool import connected_to, pending, run_trials
from app.experiments.store import Outcome, Store
from app.protocol.trial import Trial
from tests.unit.app import fake_trials
from tests.unit.app.fake_trials import DEADLY, FAILING
from tests.unit.app.trial_makers import make_trial, score_of

# distributed closes its sockets and queues when it is collected
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("default")]
PATIENCE_S = 120.0


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with connected_to(None, 2) as client:
        yield client


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store(tmp_path / "trials.sqlite") as store:
        yield store


def wait_until(true: Callable[[], object], what: str) -> None:
    until = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < until, f"not in {PATIENCE_S:g} s: {what}"
        time.sleep(0.01)


def assert_all_right(store: Store, trials: list[Trial]) -> None:
    assert pending(trials, store) == []
    kept = store.of_experiment("small")
    assert sorted(trial.id for trial in kept) == sorted(trial.id for trial in trials)
    assert {trial.id: trial.scores for trial in kept} == {trial.id: {"mark": score_of(trial)} for trial in trials}


def test_every_trial_runs_once_and_what_is_kept_does_not_run_again(client: Any, store: Store) -> None:
    trials = fake_trials.trials(100)
    for asked, new in ((trials[:40], trials[:40]), ([*trials, *trials], trials[40:])):
        told = list[str]()
        tell = lambda ended, told=told: told.extend(trial.id for trial, _ in ended)  # noqa: E731
        run_trials(asked, store, client, run=fake_trials.run, expected_s=0.1, on_ended=tell)
        assert sorted(told) == sorted(trial.id for trial in new)
    assert_all_right(store, trials)


def test_a_trial_that_fails_or_kills_its_worker_costs_the_others_nothing(client: Any, store: Store) -> None:
    good, ended = fake_trials.trials(60), dict[str, Outcome]()
    bad = [make_trial(DEADLY), make_trial(FAILING)]
    mixed = [*good[:20], *bad, *good[20:]]
    run_trials(
        mixed, store, client, run=fake_trials.run_badly, expected_s=0.1,
        on_ended=lambda some: ended.update({trial.id: outcome for trial, outcome in some}),
    )  # fmt: skip
    assert pending(mixed, store) == bad
    deadly, failing = (ended[trial.id] for trial in bad)
    assert deadly.error.startswith("KilledWorker")
    assert failing.error == "ValueError: no such door"
    run_trials(mixed, store, client, run=fake_trials.run, expected_s=0.1)  # mended: the next command runs them again
    assert_all_right(store, mixed)


def test_a_worker_that_dies_before_it_has_begun_is_begun_again() -> None:
    known = _grandchildren()

    def kill() -> None:
        wait_until(lambda: _grandchildren() - known, "a worker begins")
        os.kill((_grandchildren() - known).pop(), signal.SIGKILL)

    with ThreadPoolExecutor(1) as pool:
        killed = pool.submit(kill)
        with connected_to(None, 2) as client:
            killed.result()
            assert len(client.nthreads()) == 2


def test_workers_that_never_begin_are_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def die(*_: object, **__: object) -> None:
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr("distributed.LocalCluster", die)
    words = r"3 workers cannot begin: 5 times .*Nanny failed to start.*--workers 1"
    with pytest.raises(ValueError, match=words), connected_to(None, 3):
        pass


def _grandchildren() -> set[int]:
    """Workers are forked by a child of the client."""
    return {worker.pid for child in psutil.Process().children() for worker in child.children()}


def keys_of(client: Any) -> Any:
    """Dask's configuration as whoever has the keys of a cluster writes it."""
    keys, part = client.cluster.security, "distributed.comm.tls"
    mine = {f"{part}.client.key": keys.tls_client_key, f"{part}.client.cert": keys.tls_client_cert}
    return dask.config.set({f"{part}.ca-file": keys.tls_ca_file, **mine})


def test_a_cluster_that_exists_is_used_by_its_address_and_with_its_keys(client: Any, store: Store) -> None:
    trials = fake_trials.trials(20)
    with keys_of(client), connected_to(client.cluster.scheduler_address, None) as other:
        run_trials(trials, store, other, run=fake_trials.run, expected_s=0.1)
    assert_all_right(store, trials)
    assert len(client.nthreads()) == 2  # it lives on


def test_nobody_without_the_keys_of_the_run_is_heard_by_any_process_of_our_cluster(client: Any) -> None:
    """Dask executes what it is sent, so every port of it is closed to other users: to those who speak plainly, and to
    those who bring keys of their own."""
    workers = client.scheduler_info(n_workers=-1)["workers"]
    doors = [client.scheduler.address, *workers, *(worker["nanny"] for worker in workers.values())]
    assert len(doors) == 5
    for address in doors:
        with pytest.raises(OSError):
            Client(address, security=Security.temporary(), timeout="3s", set_as_default=False)
        host, port = address.removeprefix("tls://").split(":")
        with socket.create_connection((host, int(port)), timeout=PATIENCE_S) as plain:
            plain.sendall(b"\0" * 64)
            with contextlib.suppress(ConnectionResetError):
                assert len(plain.recv(4096)) < 100  # an alert of TLS at most, no greeting of Dask


def test_schedulers_that_are_refused(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that does not answer, and workers of another version."""
    monkeypatch.setattr("app.experiments.pool.FIND_S", 0.5)
    silent = r"--scheduler tcp://127\.0\.0\.1:9: no Dask scheduler answers"
    with pytest.raises(ValueError, match=silent), connected_to("tcp://127.0.0.1:9", None):
        pass
    monkeypatch.setattr("app.experiments.pool.FIND_S", PATIENCE_S)
    monkeypatch.setattr("app.experiments.pool._here", lambda: "0123456789ab")
    old, address = r"runs version .* of this program, not 0123456789ab", client.cluster.scheduler_address
    with keys_of(client), pytest.raises(ValueError, match=old), connected_to(address, None):
        pass


OTHERS = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    cluster = LocalCluster(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=":0")
    print(cluster.scheduler_address, flush=True)
    sys.stdin.read()
"""


@pytest.mark.parametrize("count_every_s", [0.0, 1e9], ids=["asked for its threads", "asked for results"])
def test_a_cluster_that_dies_is_told_of_and_what_had_come_is_kept(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count_every_s: float
) -> None:
    """Whichever call finds out."""
    monkeypatch.setattr("app.experiments.pool.COUNT_EVERY_S", count_every_s)
    script = tmp_path / "others_cluster.py"
    script.write_text(OTHERS, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    trials = fake_trials.trials(2000)
    with subprocess.Popen(
        [sys.executable, str(script)], text=True, env=environment, start_new_session=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    ) as cluster:  # fmt: skip

        def kill() -> None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(cluster.pid, signal.SIGKILL)

        try:
            assert cluster.stdout is not None
            address = cluster.stdout.readline().strip()
            with connected_to(address, None) as client:

                def kill_when_more_has_come(_: object) -> None:
                    wait_until(lambda: all(one.status == "finished" for one in client.futures.values()), "more results")
                    kill()

                with pytest.raises(ValueError, match="the cluster has gone; the same command goes on"):
                    run_trials(
                        trials, store, client, run=fake_trials.run, expected_s=0.1, on_ended=kill_when_more_has_come
                    )
        finally:
            kill()
    kept = len(trials) - len(pending(trials, store))
    assert 0 < kept < len(trials)
    assert all(trial.scores == {"mark": score_of(trials[trial.seed - 1000])} for trial in store.of_experiment("small"))


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGINT, 130),
        *(pytest.param(*each, marks=pytest.mark.long) for each in ((signal.SIGTERM, 143), (signal.SIGKILL, -9))),
    ],
)
def test_a_command_that_is_stopped_leaves_no_process_and_goes_on(tmp_path: Path, number: int, code: int) -> None:
    path = tmp_path / "trials.sqlite"
    command = begin(path, 600)
    with Store(path) as store:
        wait_until(lambda: len(store.of_experiment("small")) > 20, "some trials are kept")
        group = [command.pid, *(process.pid for process in psutil.Process(command.pid).children(recursive=True))]
        if number == signal.SIGINT:
            os.killpg(command.pid, number)  # as a terminal does
        else:
            os.kill(command.pid, number)
        _, said = command.communicate(timeout=PATIENCE_S)
        assert command.returncode == code
        assert "Traceback" not in said
        wait_until(lambda: not any(psutil.pid_exists(pid) for pid in group), "all processes have ended")
        kept = len(store.of_experiment("small"))
        assert 20 < kept < 600
        with begin(path, 600) as again:
            assert again.wait(PATIENCE_S) == 0
        assert_all_right(store, fake_trials.trials(600))


def begin(path: Path, count: int) -> subprocess.Popen[str]:
    """The command, in a process group of its own, as a shell begins it."""
    return subprocess.Popen(
        [sys.executable, "-m", "tests.unit.app.fake_trials", str(path), str(count)],
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, process_group=0,
    )  # fmt: skip

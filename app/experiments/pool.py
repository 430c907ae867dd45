"""The workers that run trials, some on this machine, or those of a Dask cluster that exists; handing them what is not in the
store yet, in batches; and how long that will take.

Workers are started when the first trial needs them, and ended with the command. This process alone writes to the store. This
file loads no kernel before a trial is run, as `ratslam experiment` asks it for the number of cores.
"""

from __future__ import annotations

import contextlib
import logging
import math
import multiprocessing
import os
import signal
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.code_version import code_version
from app.experiments.store import Outcome, Store
from app.protocol.experiment import Experiment
from app.protocol.trial import Result, Trial, run_trial

if TYPE_CHECKING:
    from app.protocol.trace import Trace

RunOne = Callable[[Trial], Result]

_ROOT = Path(__file__).parents[2]
HERE = "127.0.0.1"
FIND_S = 20.0  # how long to look for a scheduler
JOIN_S = 60.0  # how long to wait for its first worker
END_S = 5.0
BEGIN_TRIES = 5
_ONE_THREAD = {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_CONFIG: dict[str, Any] = {
    "distributed.scheduler.http.routes": [],  # nothing is served to browsers
    "distributed.worker.http.routes": [],
    "distributed.nanny.pre-spawn-environ": _ONE_THREAD,
    "distributed.admin.low-level-log-length": 100,
    "distributed.deploy.lost-worker-timeout": "1 day",  # a nanny starts its worker again, however slow the machine is
}


class Workers:
    """Use it in a `with` block. scheduler: the address of a Dask cluster; without one, processes on this machine."""

    def __init__(self, scheduler: str | None, count: int | None, before: Callable[[], None] = lambda: None) -> None:
        """before: done just before the workers start, such as compiling the kernels, once for all of them."""
        self._scheduler, self._before = scheduler, before
        self.count = count or cores()  # as far as is known
        self._stack = contextlib.ExitStack()
        self._client: Any = None

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        self._client = None
        self._stack.close()

    @property
    def client(self) -> Any:
        """The Dask client. ValueError: no cluster answers, or it runs another version of the program."""
        if self._client is None:
            self._before()
            self._client = self._stack.enter_context(connected_to(self._scheduler, self.count))
            self.count = max(1, sum(self._client.nthreads().values()))
        return self._client

    def traces(self, trials: Sequence[Trial]) -> list[Trace]:
        """Trials run again and written down, in this order, for the figures."""
        if not trials:
            return []
        from app.protocol.trace import trace_of

        client = self.client
        return client.gather([client.submit(trace_of, trial, pure=False, retries=1) for trial in trials])


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def connected_to(scheduler: str | None, workers: int | None) -> Generator[Any]:
    """A Dask client. scheduler: its address; without one, `workers` processes on this machine, by default one a core.

    ValueError: nobody answers there, or the workers run another version of this program.
    """
    _quiet()
    if scheduler is not None:
        with _cluster_that_exists(scheduler) as client:
            yield client
    else:
        with _cluster_of_our_own(workers or cores()) as client:
            yield client


def _quiet() -> None:
    """What goes wrong is told by the runner; connections that end with their workers are no news."""
    import distributed.config  # makes the handlers  # noqa: F401 # pyright: ignore[reportUnusedImport]

    logger = logging.getLogger("distributed")
    for one in (logger, *logger.handlers):
        one.setLevel(logging.CRITICAL)


@contextlib.contextmanager
def _cluster_of_our_own(workers: int) -> Generator[Any]:
    import dask.config
    from distributed import Client

    with dask.config.set(_CONFIG):
        _fork_ready_workers()
        cluster = _begun(workers)
        try:
            client: Any = Client(cluster, set_as_default=False)
            try:
                yield client
            finally:
                with contextlib.suppress(TimeoutError, OSError):
                    cluster.sync(_end_workers, list(cluster.workers.values()))
                    client.close(timeout=END_S)
        finally:
            with contextlib.suppress(TimeoutError, OSError):
                cluster.close(timeout=END_S)


def _fork_ready_workers() -> None:
    """Workers are forked, where that is possible, from one process that has imported all they need: the first starts
    as soon, the others at once, also those that replace one that died."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return
    import dask.config

    utils: Any = import_module("distributed.utils")  # these have no types
    server: Any = import_module("multiprocessing.forkserver")
    dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"})
    utils.get_mp_context().set_forkserver_preload(
        ["ratslam_live", "distributed", "app.experiments.pool", "app.protocol.course"]
    )
    with _environment(PYTHONPATH=str(_ROOT), PYTHONSAFEPATH="1", **_ONE_THREAD):  # this program, wherever it is called
        server.ensure_running()


@contextlib.contextmanager
def _environment(**values: str) -> Generator[None]:
    """For the time of the block, these variables have these values."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _begun(workers: int) -> Any:
    """A cluster with all its workers. If one dies before it has begun, which nobody starts again, all are begun anew."""
    from distributed import LocalCluster

    # Whoever reaches a scheduler has it run what they like. Keys of this run alone, in memory, keep other users out.
    security: Any = import_module("distributed.security")  # it has no types
    keys = security.Security.temporary()
    for more in range(BEGIN_TRIES - 1, -1, -1):
        try:
            return LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, host=HERE, memory_limit=0,
                dashboard_address=f"{HERE}:0", scheduler_kwargs={"dashboard": False}, silence_logs=logging.CRITICAL,
                preload=["ratslam_live", "app.experiments.pool"], security=keys,
            )  # fmt: skip
        except RuntimeError as error:
            if not more:
                raise ValueError(
                    f"{workers} workers cannot begin: {BEGIN_TRIES} times one of them died at once ({error}); with too little "
                    "memory for so many, try fewer (--workers 1)"
                ) from None
    raise AssertionError("unreachable")


async def _end_workers(nannies: list[Any]) -> None:
    """What they are doing is not waited for, and nobody starts them again."""
    for nanny in nannies:
        nanny.close_gracefully(reason="the client ends")
        if nanny.pid:
            with contextlib.suppress(ProcessLookupError):
                os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _cluster_that_exists(address: str) -> Generator[Any]:
    from distributed import Client

    try:
        client: Any = Client(address, timeout=FIND_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise ValueError(
            f"--scheduler {address}: no Dask scheduler answers ({error}); expected such as tcp://{HERE}:8786"
        ) from None
    try:
        try:
            client.wait_for_workers(1, timeout=JOIN_S)
        except TimeoutError:
            raise ValueError(
                f"--scheduler {address}: it has no workers; start some there with `dask worker {address}`"
            ) from None
        _check_versions(client, address)
        yield client
    finally:
        client.close(timeout=END_S)


def _here() -> str:
    return code_version()


def _check_versions(client: Any, address: str) -> None:
    here = _here()
    try:
        versions: dict[str, str] = client.run(code_version)
    except Exception as error:
        raise ValueError(
            f"--scheduler {address}: its workers do not know this program ({error}); install it there, in the same version"
        ) from None
    for worker, version in versions.items():
        if version != here:
            raise ValueError(
                f"--scheduler {address}: {worker} runs version {version} of this program, not {here}; make them equal"
            )


def run_stored(trial: Trial) -> Result:
    """Run a trial to its end. ValueError if it was made by another version of the program than this worker's."""
    if trial.version != code_version():
        raise ValueError(f"this worker's program is version {code_version()}, the trial is of {trial.version}")
    return run_trial(trial)[0]


def run_batch(trials: Sequence[Trial], run: RunOne) -> list[Outcome]:
    """A trial that fails is an outcome, too: the others of its batch go on."""
    return [_outcome(trial, run) for trial in trials]


def _outcome(trial: Trial, run: RunOne) -> Outcome:
    try:
        return Outcome(trial.id, run(trial))
    except Exception as error:
        return Outcome(trial.id, error=f"{type(error).__name__}: {error}")


def dask_setup(_worker: object) -> None:
    """Called by Dask in each worker of our own cluster: one core each, and Ctrl+C is the client's matter."""
    import cv2

    cv2.setNumThreads(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


BATCH_S = 2.0  # work in a batch: what is lost with a worker, against what handing it out costs
MOST_AT_ONCE = 250  # trials in a batch, if they do nothing
AHEAD = 3  # batches handed out for each thread, so that none waits for the client
TRIES = 4  # a trial whose worker died so often has failed
COUNT_EVERY_S = 2.0  # how often the threads are counted: a cluster may grow
REAL_TIMES = 100.0  # simulated seconds in one of a core, where nothing has been measured
SET_UP_S = 0.5  # of a session

OnEnded = Callable[[Sequence[tuple[Trial, Outcome]]], None]


def pending(trials: Iterable[Trial], store: Store) -> list[Trial]:
    """The trials that have no scores yet, each once, in their order."""
    by_id = {trial.id: trial for trial in trials}
    done = store.done(by_id)
    return [trial for trial in by_id.values() if trial.id not in done]


def run_trials(
    trials: Iterable[Trial], store: Store, client: Any, *, expected_s: float = BATCH_S, run: RunOne = run_stored,
    on_ended: OnEnded | None = None,
) -> None:  # fmt: skip
    """Run what is pending. expected_s: about how long a trial takes; run: what a worker does with it.

    on_ended: is called with what has ended and is kept. ValueError: the cluster has gone; what had come is kept.
    """
    running = _Running(pending(trials, store), client, run, expected_s)
    for ended in running.ended():
        store.add(ended)
        if on_ended is not None:
            on_ended(ended)


class _Running:
    """Batches on their way. A batch whose worker died is handed out again, trial by trial: one of them may be to blame."""

    def __init__(self, trials: list[Trial], client: Any, run: RunOne, expected_s: float) -> None:
        self._waiting = deque(trials)
        self._suspects: deque[Trial] = deque()  # each goes alone
        self._client, self._run = client, run
        self._each_s, self._seen, self._spent_s = expected_s, 0, 0.0
        self._air: dict[Any, list[Trial]] = {}
        self._tries: Counter[str] = Counter()
        self._threads, self._counted_s = 1, -math.inf

    def ended(self) -> Iterable[list[tuple[Trial, Outcome]]]:
        """What ends, as it does. ValueError: the cluster has gone, whichever call to it was the first to find that out."""
        try:
            yield from self._ended()
        except (CancelledError, OSError):
            raise ValueError("the cluster has gone; the same command goes on where this one stopped") from None

    def _ended(self) -> Iterable[list[tuple[Trial, Outcome]]]:
        from distributed import as_completed

        coming: Any = as_completed(loop=self._client.loop)
        self._hand_out(coming)
        try:
            for future in coming:
                if future.status in ("pending", "lost"):  # its worker died with the result, and it is run again
                    coming.add(future)
                    continue
                ended = self._taken(future, self._air.pop(future))
                self._hand_out(coming)
                if ended:
                    yield ended
        finally:
            if self._air:
                self._client.cancel(list(self._air), force=True)

    def _taken(self, future: Any, batch: list[Trial]) -> list[tuple[Trial, Outcome]]:
        try:
            outcomes: dict[str, Outcome] = {outcome.trial_id: outcome for outcome in future.result()}
        except CancelledError:
            raise
        except Exception as error:
            return self._tried(batch, f"{type(error).__name__}: {error}")
        self._learn(list(outcomes.values()))
        return [(trial, outcomes[trial.id]) for trial in batch]

    def _tried(self, batch: list[Trial], error: str) -> list[tuple[Trial, Outcome]]:
        """Their worker died, or could not be given them."""
        failed: list[tuple[Trial, Outcome]] = []
        for trial in batch:
            self._tries[trial.id] += 1
            if self._tries[trial.id] < TRIES:
                self._suspects.append(trial)
            else:
                failed.append((trial, Outcome(trial.id, error=error)))
        return failed

    def _learn(self, outcomes: list[Outcome]) -> None:
        walls = [outcome.result.wall_s for outcome in outcomes if outcome.result is not None]
        self._seen, self._spent_s = self._seen + len(walls), self._spent_s + sum(walls)
        if self._seen:
            self._each_s = self._spent_s / self._seen

    def _hand_out(self, coming: Any) -> None:
        while len(self._air) < AHEAD * self._count_threads() and (self._suspects or self._waiting):
            batch = [self._suspects.popleft()] if self._suspects else self._next_batch()
            future = self._client.submit(run_batch, batch, self._run, pure=False, retries=1)
            self._air[future] = batch
            coming.add(future)

    def _next_batch(self) -> list[Trial]:
        fair = math.ceil(len(self._waiting) / (AHEAD * self._threads))  # towards the end, all are kept busy
        wanted = round(BATCH_S / max(self._each_s, BATCH_S / MOST_AT_ONCE))
        return [self._waiting.popleft() for _ in range(max(1, min(wanted, fair)))]

    def _count_threads(self) -> int:
        now_s = time.monotonic()
        if now_s - self._counted_s > COUNT_EVERY_S:
            self._threads, self._counted_s = max(1, sum(self._client.nthreads().values())), now_s
        return self._threads


@dataclass(frozen=True, slots=True)
class Duration:
    """Wall time of trials on one core, in s. measured: each engine's from trials that were run on this store's machine."""

    seconds: float
    trials: int
    measured: bool

    def words(self, workers: int) -> str:
        """Such as `12 min, measured`."""
        return f"{time_words(self.seconds / max(1, workers))}, {'measured' if self.measured else 'estimated'}"


def duration_of(
    experiment: Experiment, trials: Counter[str], measured: dict[str, float], quick: bool = False
) -> Duration:
    """trials: how many, by engine. measured: wall seconds of a trial, by engine, as far as they are known."""
    estimated_s = experiment.seconds(quick) / REAL_TIMES + SET_UP_S
    seconds = sum(measured.get(engine, estimated_s) * count for engine, count in trials.items())
    return Duration(seconds, trials.total(), all(engine in measured for engine in trials))


def time_words(seconds: float) -> str:
    """Such as `40 s`, `12 min` or `3.5 h`."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"

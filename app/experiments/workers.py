"""The workers that run trials: some on this machine, or those of a Dask cluster that exists.

They are started when the first trial needs them, and ended with the command. A worker runs a batch of trials, one after the
other. This file loads no kernel before a trial is run, as `ratslam experiment` asks it for the number of cores.
"""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.code_version import code_version
from app.experiments.store import Outcome
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
        ["ratslam_live", "distributed", "app.experiments.workers", "app.protocol.course"]
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
                preload=["ratslam_live", "app.experiments.workers"], security=keys,
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

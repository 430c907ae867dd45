"""The workers of one command: started when the first trial needs them, and ended with it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import Any

from app.experiments.cluster import connected_to, cores
from app.trials.trace import Trace, trace_of
from app.trials.trial import Trial


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
        client = self.client
        return client.gather([client.submit(trace_of, trial, pure=False, retries=1) for trial in trials])

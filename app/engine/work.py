"""Work on the past that may take seconds. It is done in slices, so that other commands and ticks come in between."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator

from web.messages import Accepted, Refused, Request

SLICE_S = 0.02  # a newer request is read after it


class Work:
    """words: what is being done, for people. steps: yield the share that is done, from 0 to 1; a step takes milliseconds.

    moves: it changes which moment is shown, so that nothing else may do that at the same time. How long slices are changes
    nothing in what comes of it.
    """

    def __init__(self, words: str, steps: Generator[float], *, moves: bool) -> None:
        self.words, self.moves = words, moves
        self.share = 0.0
        self.plays = False  # the past plays on from the moment that is gone to
        self.request: Request | None = None  # is answered when it is done
        self._steps = steps

    def go_on(self, for_s: float) -> bool:
        """Work for so long (wall time), at least one step. True when all is done."""
        until_s = time.perf_counter() + for_s
        for share in self._steps:
            self.share = share
            if time.perf_counter() >= until_s:
                return False
        return True

    def end(self) -> None:
        """Leave it where it is."""
        self._steps.close()


class Slices:
    """The work that is going on, if any."""

    def __init__(
        self, answer: Callable[[Request, Accepted | Refused], None], fail: Callable[[BaseException], None]
    ) -> None:
        """answer: is called for whoever waits for the work. fail: is called with what went wrong in it."""
        self.first_s = math.inf  # of the first slice: with nobody to come in between, all is done at once
        self.work: Work | None = None
        self._answer, self._fail = answer, fail

    def begin(self, work: Work, tick: int) -> bool:
        """Begin this work instead of any other. True when it is done already. tick: that is shown. What the work raises in
        its first slice is raised."""
        self.drop(tick)
        if work.go_on(self.first_s):
            return True
        self.work = work
        return False

    def go_on(self, tick: Callable[[], int]) -> None:
        """Work for a slice. tick: that is shown."""
        work = self.work
        if work is None:
            return
        try:
            if not work.go_on(SLICE_S):
                return
        except BaseException as error:
            self.work = None
            if work.request is not None:
                self._answer(work.request, Refused("type", work.words, str(error)))
            self._fail(error)
            return
        self.drop(tick())

    def drop(self, tick: int, *, unless_still: bool = False) -> None:
        """Leave the work where it is. Whoever waits for it is answered with the tick that is shown.

        unless_still: only if it changes which moment is shown.
        """
        work = self.work
        if work is None or (unless_still and not work.moves):
            return
        self.work = None
        work.end()
        if work.request is not None:
            self._answer(work.request, Accepted(tick))

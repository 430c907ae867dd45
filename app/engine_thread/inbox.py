"""Requests to the engine and its answers. Every request gets an answer, even after the engine has ended."""

from __future__ import annotations

import contextlib
import queue
import threading
from concurrent.futures import Future

from web import messages as m

Answer = m.Accepted | m.Refused | BaseException


class Inbox:
    """`submit` and `wake` may be called from any thread, the rest only from the engine's."""

    def __init__(self) -> None:
        self._requests: queue.SimpleQueue[m.Request | None] = queue.SimpleQueue()
        self._answers: list[tuple[m.Request, Answer]] = []
        self._gate, self._over = threading.Lock(), ""  # why nothing is taken any more

    def submit(self, command: m.Command | m.EngineRequest) -> Future[m.Accepted | m.Refused]:
        answer: Future[m.Accepted | m.Refused] = Future()
        request = m.Request(command, answer)
        with self._gate:
            if not self._over:
                self._requests.put(request)
                return answer
        answer.set_result(_refused(request, self._over))
        return answer

    def wake(self) -> None:
        """End a `take` that is waiting."""
        self._requests.put(None)

    def take(self, patience_s: float) -> m.Request | None:
        """The next request, or None if none comes within `patience_s`."""
        with contextlib.suppress(queue.Empty):
            return self._requests.get(block=patience_s > 0, timeout=max(patience_s, 0.0))
        return None

    @property
    def has_answers(self) -> bool:
        return bool(self._answers)

    @property
    def is_empty(self) -> bool:
        """Whether nobody waits to be heard."""
        return self._requests.empty()

    def has_news(self, *others: type) -> bool:
        """Whether one of the answers is to what may have changed something that is shown. others: what has not, this
        time."""
        return any(not isinstance(request.command, (*m.READS, *others)) for request, _ in self._answers)

    def answer(self, request: m.Request, answer: Answer) -> None:
        """Keep an answer until the next `give`."""
        self._answers.append((request, answer))

    def give(self) -> None:
        answers, self._answers = self._answers, []
        for request, answer in answers:
            if not request.answer.set_running_or_notify_cancel():
                continue  # whoever asked has cancelled
            if isinstance(answer, BaseException):
                request.answer.set_exception(answer)
            else:
                request.answer.set_result(answer)

    def close(self, why: str) -> None:
        """Take no more requests. Those that wait and those that still come are refused with the sentence `why`."""
        with self._gate:
            self._over = why
        while not self._requests.empty():
            request = self._requests.get()
            if request is not None:
                self.answer(request, _refused(request, why))
        self.give()


def _refused(request: m.Request, why: str) -> m.Refused:
    return m.Refused("type", getattr(request.command, "type", type(request.command).__name__), why)

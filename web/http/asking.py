"""The one place in `web` that asks the engine. A refusal becomes a `Declined`, which is turned into an answer further
out: by `answer_declined` for HTTP, by the stream for its pages."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from typing import cast

from sim2d import World
from web.http.commands import Declined, Malformed, wrong
from web.messages import Accepted, Command, CompareBranch, EngineRequest, OfficeEdition, ReadWorld, Refused, Seek, Step

Submit = Callable[[Command | EngineRequest], "Future[Accepted | Refused]"]

ANSWER_TIMEOUT_S = 3.0
PAST_TIMEOUT_S = 300.0  # the page is told how far it is, and a newer wish ends it
TICK_TIMEOUT_S = 0.1  # a step is answered when its ticks are done


class NoAnswer(Declined):
    """The engine did not answer in time, or failed at the command; `status` is the HTTP status."""


async def told(submit: Submit, command: Command | EngineRequest, timeout_s: float | None = None) -> Accepted:
    """The engine's answer to a command that it has taken. Raises Malformed when it refuses, and NoAnswer."""
    answer = asyncio.wrap_future(submit(command))
    if timeout_s is None:
        timeout_s = ANSWER_TIMEOUT_S + (TICK_TIMEOUT_S * command.ticks if isinstance(command, Step) else 0.0)
        timeout_s = PAST_TIMEOUT_S if isinstance(command, Seek | CompareBranch) else timeout_s
    done, _ = await asyncio.wait({answer}, timeout=timeout_s)
    if not done:
        late = f"the engine did not answer within {timeout_s:g} s; the command may still take effect, see /api/state"
        raise NoAnswer.of(503, late)
    error = answer.exception()
    if error is not None:
        raise NoAnswer.of(500, f"the engine failed at this command: {type(error).__name__}: {error}")
    said = answer.result()
    if isinstance(said, Refused):
        raise Malformed([wrong(said.field, said.value, said.reason)])
    return said


async def world_now(submit: Submit) -> tuple[World, OfficeEdition]:
    result = (await told(submit, ReadWorld())).result
    assert isinstance(result, tuple)
    return cast("tuple[World, OfficeEdition]", result)

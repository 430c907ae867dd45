from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from app.config import Config
from app.engine_thread import EngineThread

from .engine_threads import OFFICE, snapshot


@pytest.fixture
def start() -> Iterator[Callable[..., EngineThread]]:
    """Engines that are stopped at the end; paused and as fast as possible unless told otherwise."""
    running: list[EngineThread] = []

    def begin(**options: object) -> EngineThread:
        world = options.pop("world", OFFICE)
        config = options.pop("config", Config())
        options = {"speed": 0.0, "running": False} | options
        made = EngineThread(world, 5, config, **options)  # type: ignore[arg-type]
        made.start()
        running.append(made)
        snapshot(made)
        return made

    yield begin
    for made in running:
        made.stop()

"""The one thread in which the session runs: pace, queue and publishing."""

from app.engine_thread.thread import EngineThread

__all__ = ["EngineThread"]

"""The one thread that the session runs in: queue and publishing, at its pace."""

from app.engine_thread.thread import EngineThread

__all__ = ["EngineThread"]

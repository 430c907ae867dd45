"""Runs that keep themselves: on disk, as their beginning and the orders that were given."""

from app.runs.run_file import KeptRun, open_run

__all__ = ["KeptRun", "open_run"]

"""The closed loop without a server, as fast as possible: exploring, goals and deliveries, and their reports."""

from app.headless.deliveries import Deliveries
from app.headless.report import BrainFile
from app.headless.run import run_headless

__all__ = ["BrainFile", "Deliveries", "run_headless"]

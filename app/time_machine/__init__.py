"""The past of a run: keyframes, moments made again from them, and branches."""

from app.time_machine.comparison import first_difference, side_of
from app.time_machine.machine import Branch, Moment, PastRoom, TimeMachine

__all__ = ["Branch", "Moment", "PastRoom", "TimeMachine", "first_difference", "side_of"]

"""One handler a command: found by the command's class in `table.py`."""

from app.commands.outcome import Later
from app.commands.table import carry_out

__all__ = ["Later", "carry_out"]

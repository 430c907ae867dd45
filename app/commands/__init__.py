"""One handler for each command; `table.py` finds it by the command's class."""

from app.commands.outcome import Later, Working
from app.commands.table import carry_out

__all__ = ["Later", "Working", "carry_out"]

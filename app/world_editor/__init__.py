"""Editing the office while the robot drives."""

from app.world_editor.edits import edited
from app.world_editor.history import MOST_UNDOS, WorldEditor

__all__ = ["MOST_UNDOS", "WorldEditor", "edited"]

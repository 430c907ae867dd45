"""Situations: a run up to a moment as one link or one file, which anybody can play again to the same bits."""

from app.situations.document import LONGEST_LINK, file_of, link_of, read_situation
from app.situations.situation import LedHere, Situation

__all__ = ["LONGEST_LINK", "LedHere", "Situation", "file_of", "link_of", "read_situation"]

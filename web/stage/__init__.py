"""The 3-D stage and its side panel, drawn with viser. `Stage` is all that others need."""

from web.stage.stage import Stage

__all__ = ["Stage"]

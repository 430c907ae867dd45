"""The 3-D viewer, drawn with viser: three plates, and what a pointer does on them. `Viewers` is all that others need."""

from web.viewer.viewer import Viewer, Viewers

__all__ = ["Viewer", "Viewers"]

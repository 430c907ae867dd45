"""What is laid over the stage when somebody wants it: occupancy, goal memory. One switch for all who look."""

from __future__ import annotations

from typing import Literal, get_args

import viser

Overlay = Literal["occupancy", "cell_occupancy", "goal_memory"]
OVERLAYS: tuple[Overlay, ...] = get_args(Overlay)
WORDS: dict[Overlay, tuple[str, str]] = {
    "occupancy": ("occupancy, map", "Where the sonars met something, bent with the map: free is bright."),
    "cell_occupancy": (
        "occupancy, cells",
        "The same in the frame of the pose cells, which wraps and jumps.",
    ),
    "goal_memory": (
        "goal memory",
        "Seconds from each pose cell to the goal, and where they fall fastest. Needs a goal.",
    ),
}
ON: frozenset[Overlay] = frozenset({"occupancy", "goal_memory"})


class Switches:
    """`is_on` is asked in the stage's thread; people turn them in viser's."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("On the stage", expand_by_default=True):
            self._handles = {
                overlay: gui.add_checkbox(words, overlay in ON, hint=hint) for overlay, (words, hint) in WORDS.items()
            }

    def is_on(self, overlay: Overlay) -> bool:
        return bool(self._handles[overlay].value)

    def turn(self, overlay: Overlay, on: bool) -> None:
        self._handles[overlay].value = on

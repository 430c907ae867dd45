"""The switches that all pages share: layers over the plates, and what a click on the map does."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

Name = Literal[
    "occupancy", "cell_occupancy", "goal_memory", "movements", "click_inspects", "ghost", "outline", "doubt", "closures"
]  # fmt: skip
NAMES: tuple[Name, ...] = get_args(Name)


@dataclass(frozen=True)
class Switch:
    """One switch as the panel shows it."""

    name: Name
    tab: str
    words: str
    hint: str
    on: bool  # at the start


SWITCHES = (
    Switch(
        "occupancy",
        "Memory",
        "Occupancy on the map",
        "Where the sonars met something, bent with the map: free is bright.",
        True,
    ),
    Switch(
        "cell_occupancy",
        "Memory",
        "Occupancy among the pose cells",
        "The same in the frame of the pose cells, which wraps and jumps.",
        False,
    ),
    Switch(
        "goal_memory",
        "Memory",
        "Goal memory",
        "Seconds from each pose cell to the goal, and where they fall fastest. Needs a goal.",
        True,
    ),
    Switch(
        "movements",
        "Memory",
        "Candidate movements",
        "The arcs that the robot tries, 2.5 times as large: grey where an echo is too close, bold where it goes.",
        False,
    ),
    Switch(
        "click_inspects",
        "Inspect",
        "Click inspects",
        "A click on the map, instead of sending the robot there. With shift it always does.",
        False,
    ),
    Switch(
        "ghost",
        "Truth",
        "The wheels alone, as a ghost",
        "Where the robot would be, in office and map, if it believed its wheels alone from the start.",
        True,
    ),
    Switch(
        "outline",
        "Truth",
        "True walls under the map",
        "Laid under the map by the fit after which the map error is measured.",
        True,
    ),
    Switch(
        "doubt",
        "Truth",
        "Error and doubt on the map",
        "A line to where the robot truly is. The ellipse [ours]: two standard deviations of its own estimate.",
        True,
    ),
    Switch(
        "closures",
        "Truth",
        "Closed loops on the map",
        "A ring where a loop was closed of late. A click on it plays the correction again; without rings it sets a goal.",
        True,
    ),
)


class Switches:
    """May be used from any thread. `on` is another object after each change."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.on: frozenset[Name] = frozenset(switch.name for switch in SWITCHES if switch.on)
        self.on_turn: Callable[[], None] | None = None  # called after each change, in the thread that made it

    def is_on(self, name: Name) -> bool:
        return name in self.on

    def turn(self, name: Name, on: bool) -> None:
        with self._lock:
            self.on = frozenset(n for n in NAMES if (on if n == name else n in self.on))
        if self.on_turn is not None:
            self.on_turn()

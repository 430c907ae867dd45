"""The colours that all figures share."""

from __future__ import annotations

INK, SOFT, WALL, FAINT, PAPER = "#1f2328", "#5b626a", "#8a9199", "#d9dde1", "#ffffff"
BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
ORANGE, SKY, BLACK = "#e69f00", "#56b4e9", "#000000"

CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, SOFT)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
ENGINE_COLOUR = {"paper": BLUE, "paper-2005": GREEN, "paper-2006": PURPLE, "ours": VERMILION}
# The page has its own shade of each, for light and dark.
THEMED = {
    INK: "ink", SOFT: "soft", WALL: "wall", FAINT: "faint", PAPER: "paper", BLACK: "ink",
    BLUE: "blue", VERMILION: "vermilion", GREEN: "green", PURPLE: "purple", ORANGE: "orange", SKY: "sky",
}  # fmt: skip

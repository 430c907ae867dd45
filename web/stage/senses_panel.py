"""Senses: what the camera sees, the best view it reminds of, how different they are, which cells are active."""

from __future__ import annotations

import html
import math
from collections import deque

import numpy as np
import viser

from web.messages import PoseCellLayer, Senses, Snapshot
from web.stage import markup
from web.stage.cell_fit import CellFit
from web.stage.images import Pixels
from web.stage.palette import Palette, mix

STRIP_HW = (6, 34)  # squares of the strip of local view cells
SQUARE = 6
RECENT = 60


class SensesPanel:
    def __init__(self, gui: viser.GuiApi, palette: Palette) -> None:
        self.palette = palette
        self._recent: deque[int] = deque(maxlen=RECENT)
        self._last: Senses | None = None
        self._views = gui.add_html("")
        self._cells = gui.add_html("")

    def reset(self) -> None:
        self._recent.clear()

    def remember(self, senses: Senses) -> None:
        """Keeps the views that were active lately, for the strip of cells."""
        new = senses is not self._last and senses.active_view >= 0
        if new and (not self._recent or self._recent[-1] != senses.active_view):
            self._recent.append(senses.active_view)
        self._last = senses

    def draw_views(self, senses: Senses) -> None:
        self._views.content = views_page(senses, self.palette)

    def draw_cells(self, layer: PoseCellLayer, snapshot: Snapshot) -> None:
        self._cells.content = cells_page(layer, snapshot, tuple(self._recent), self.palette)


def views_page(senses: Senses, palette: Palette) -> str:
    """Camera and verdict, what the front end makes of it and the best match, and the difference against its threshold."""
    height, width = senses.camera.shape[:2]
    camera = markup.caption("camera") + markup.picture(senses.camera, "what the robot's camera sees", width / height)
    seen = markup.caption(f"{senses.front_end} now") + _view(senses.seen, f"the present view: {senses.seen_words}")
    best = markup.caption("best match") + markup.blank("none yet: every view is new", _aspect(senses.seen))
    if senses.best is not None:
        words = f"the stored view {senses.best_view}: {senses.best_words}"
        best = markup.caption(f"best match #{senses.best_view}") + markup.choice(
            "view", senses.best_view, _view(senses.best, words)
        )
    return markup.page(
        markup.row(camera, _verdict(senses, palette)), markup.row(seen, best), _difference(senses, palette)
    )


def _view(pixels: Pixels, words: str) -> str:
    return markup.picture(pixels, words, _aspect(pixels))


def _aspect(pixels: Pixels) -> float:
    return pixels.shape[1] / pixels.shape[0]


def _verdict(senses: Senses, palette: Palette) -> str:
    """Which view is active, and whether it is new."""
    number = f"#{senses.active_view}" if senses.active_view >= 0 else "none"
    words, colour = "nothing to see", palette.text_2
    if senses.active_view >= 0:
        words, colour = (
            ("new: recruited", palette.robot) if senses.recruited else ("known: recalled", palette.packets[1])
        )
    if senses.false_positive:
        words, colour = f"false positive {senses.false_positives}: rightly #{senses.best_view}", palette.robot
    shape = "display:inline-block;width:9px;height:9px;border-radius:2px"
    dot = f'<span style="{shape};background:{markup.css(colour)}"></span>'
    big = f'<div style="font-size:27px;font-weight:700;line-height:1.2">{html.escape(number)}</div>'
    return f"{markup.caption('active view')}{big}<div>{dot} {html.escape(words)}</div>"


def _difference(senses: Senses, palette: Palette) -> str:
    """Full scale is twice the threshold; the mark in the middle is the threshold."""
    words, share = "difference: nothing to compare with", 1.0
    if math.isfinite(senses.difference):
        words = f"difference to the best view {senses.difference:.1f}   (threshold {senses.threshold:.1f})"
        share = senses.difference / max(2 * senses.threshold, 1e-9)
    colour = palette.packets[1] if senses.difference <= senses.threshold else palette.robot
    return markup.caption(words) + markup.bar(share, colour, palette.text_2, 0.5)


def cells_page(layer: PoseCellLayer, snapshot: Snapshot, recent: tuple[int, ...], palette: Palette) -> str:
    """Local view cells, pose cells from above and the histogram of headings."""
    active = snapshot.senses.active_view
    shown = f"active #{active} of {snapshot.views}" if active >= 0 else f"none active of {snapshot.views}"
    strip = view_strip(active, snapshot.views, recent, palette)
    above = markup.picture(from_above(layer, palette), "pose cells seen from above, x' to the right", 1.0)
    turns = np.bincount(layer.cells[:, 0], weights=layer.activity, minlength=layer.shape[0])
    bars = markup.histogram(turns, palette.packets[0], "activity by heading", 1.12, ("0°", "180°", "360°"))
    return markup.page(
        markup.caption(f"local view cells ({shown})"),
        _clickable(markup.picture(strip, f"local view cells, {shown}", STRIP_HW[1] / STRIP_HW[0]), snapshot.views),
        markup.row(markup.caption("pose cells from above") + above, markup.caption("heading θ′") + bars),
    )


def view_strip(active: int, views: int, recent: tuple[int, ...], palette: Palette) -> Pixels:
    """A square for each view (or for several neighbours), lit while active and fading for a while after; RGBA."""
    rows, columns = STRIP_HW
    count = rows * columns
    squares = np.tile(np.array((*palette.text_2, 18), np.uint8), (count, 1))
    per_square = views_a_square(views)
    squares[: -(-views // per_square), 3] = 60
    quiet = mix(palette.panel, palette.text_2, 0.3)
    for age, view in zip(range(len(recent), 0, -1), recent, strict=True):
        squares[min(view // per_square, count - 1)] = (*mix(palette.packets[0], quiet, age / (RECENT + 1)), 255)
    if active >= 0:
        squares[min(active // per_square, count - 1)] = (*palette.robot, 255)
    large = np.repeat(np.repeat(squares.reshape(rows, columns, 4), SQUARE, 0), SQUARE, 1)
    large[SQUARE - 1 :: SQUARE, :, 3] = 0
    large[:, SQUARE - 1 :: SQUARE, 3] = 0
    return large


def views_a_square(views: int) -> int:
    return max(1, -(-views // (STRIP_HW[0] * STRIP_HW[1])))


def _clickable(strip: str, views: int) -> str:
    """A click on a square inspects its first view; web/static/stage.js reckons which."""
    rows, columns = STRIP_HW
    shape = f'data-rows="{rows}" data-columns="{columns}" data-each="{views_a_square(views)}" data-views="{views}"'
    return f'<div class="view-strip" {shape} style="cursor:pointer">{strip}</div>'


def from_above(layer: PoseCellLayer, palette: Palette) -> Pixels:
    """The activity summed over theta', front row at the bottom, each cell in its packet's colour; RGBA (n_y, n_x)."""
    _, n_y, n_x = layer.shape
    light, weight = np.zeros((n_y, n_x, 3)), np.zeros((n_y, n_x, 1))
    colours = np.array(palette.packets, np.float64)[np.minimum(CellFit(layer.shape).owners(layer), 3)]
    at = (layer.cells[:, 1], layer.cells[:, 2])
    np.add.at(light, at, colours * layer.activity[:, None])
    np.add.at(weight, at, layer.activity[:, None])
    share = np.sqrt(weight / max(float(weight.max()), 1e-9))
    shown = np.where(weight > 0, light / np.maximum(weight, 1e-12), palette.text_2)
    opacity = 28 + share * (255 - 28)
    return np.concatenate([shown, opacity], 2)[::-1].astype(np.uint8)

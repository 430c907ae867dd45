"""Senses: what the camera sees, the best view it reminds of, how different they are, which cells are active."""

from __future__ import annotations

import math
from collections import deque

import cv2
import numpy as np
import viser

from web.messages import PoseCellLayer, Senses, Snapshot
from web.stage import images
from web.stage.cell_fit import CellFit
from web.stage.palette import Palette, Rgb, mix

WIDTH = 616  # pixels, shown at about half of it
COLUMN = 302
STRIP_HW = (6, 34)  # local view cells
RECENT = 60
CAPTION = 22


class SensesPanel:
    def __init__(self, gui: viser.GuiApi, palette: Palette) -> None:
        self.palette = palette
        self._recent: deque[int] = deque(maxlen=RECENT)
        self._last: Senses | None = None
        blank = np.zeros((4, WIDTH, 3), np.uint8)
        blank[:] = palette.panel
        self._views = gui.add_image(blank, format="png")
        self._cells = gui.add_image(blank, format="png")

    def reset(self) -> None:
        self._recent.clear()

    def remember(self, senses: Senses) -> None:
        """Keeps the views that were active lately, for the strip of cells."""
        if senses is not self._last and senses.active_view >= 0 and (not self._recent or self._recent[-1] != senses.active_view):
            self._recent.append(senses.active_view)
        self._last = senses

    def draw_views(self, senses: Senses) -> None:
        self._views.image = views_image(senses, self.palette)

    def draw_cells(self, layer: PoseCellLayer, snapshot: Snapshot) -> None:
        self._cells.image = cells_image(layer, snapshot, tuple(self._recent), self.palette)


def views_image(senses: Senses, palette: Palette) -> images.Pixels:
    """Camera and verdict, template and best match, and the difference against its threshold."""
    canvas = _blank(580, palette)
    ink, faint = palette.text, palette.text_2
    camera_h = 226
    images.write(canvas, "camera", faint, 0, 0, CAPTION)
    images.paste(canvas, images.nearest(senses.camera, (camera_h, COLUMN)), 0, 32)
    _verdict(canvas, senses, palette)
    top = 32 + camera_h + 14
    images.write(canvas, "template now", faint, 0, top, CAPTION)
    images.paste(canvas, images.nearest(senses.template, (200, COLUMN)), 0, top + 32)
    right = WIDTH - COLUMN
    if senses.best is None:
        images.write(canvas, "best match", faint, right, top, CAPTION)
        canvas[top + 32 : top + 232, right:] = mix(palette.panel, palette.text_2, 0.12)
        images.write(canvas, "none yet: every", faint, right + 52, top + 100, CAPTION)
        images.write(canvas, "view is new", faint, right + 76, top + 132, CAPTION)
    else:
        images.write(canvas, f"best match  #{senses.best_view}", faint, right, top, CAPTION)
        images.paste(canvas, images.nearest(senses.best, (200, COLUMN)), right, top + 32)
    top += 246
    words = "difference: nothing to compare with"
    if math.isfinite(senses.difference):
        words = f"difference to the best view {senses.difference:.1f}   threshold {senses.threshold:.1f}"
    images.write(canvas, words, ink, 0, top, CAPTION)
    _difference_bar(canvas, senses, palette, top + 38)
    return canvas


def _verdict(canvas: images.Pixels, senses: Senses, palette: Palette) -> None:
    """To the right of the camera: which view is active, and whether it is new."""
    left = WIDTH - COLUMN + 8
    images.write(canvas, "active view", palette.text_2, left, 32, CAPTION)
    number = f"#{senses.active_view}" if senses.active_view >= 0 else "none"
    images.write(canvas, number, palette.text, left, 60, 58, True)
    words, colour = ("nothing to see", palette.text_2)
    if senses.active_view >= 0:
        words, colour = ("new: recruited", palette.robot) if senses.recruited else ("known: recalled", palette.packets[1])
    canvas[158:178, left : left + 20] = colour
    images.write(canvas, words, palette.text, left + 32, 154, 24)


def _difference_bar(canvas: images.Pixels, senses: Senses, palette: Palette, top: int) -> None:
    """Full scale is twice the threshold; the mark in the middle is the threshold."""
    canvas[top : top + 16] = mix(palette.panel, palette.text_2, 0.22)
    share = senses.difference / max(2 * senses.threshold, 1e-9) if math.isfinite(senses.difference) else 1.0
    known = senses.difference < senses.threshold
    canvas[top : top + 16, : round(min(max(share, 0.0), 1.0) * WIDTH)] = palette.packets[1] if known else palette.robot
    canvas[top - 6 : top + 22, WIDTH // 2 - 2 : WIDTH // 2 + 2] = palette.text


def cells_image(layer: PoseCellLayer, snapshot: Snapshot, recent: tuple[int, ...], palette: Palette) -> images.Pixels:
    """Local view cells, pose cells from above and the histogram of headings."""
    canvas = _blank(480, palette)
    active = snapshot.senses.active_view
    shown = f"active #{active} of {snapshot.views}" if active >= 0 else f"none active of {snapshot.views}"
    images.write(canvas, f"local view cells  ({shown})", palette.text_2, 0, 0, CAPTION)
    strip = view_strip(active, snapshot.views, recent, palette)
    images.paste(canvas, strip, 0, 32)
    top = 32 + strip.shape[0] + 16
    images.write(canvas, "pose cells from above", palette.text_2, 0, top, CAPTION)
    images.paste(canvas, from_above(layer, palette, 270), 0, top + 32)
    images.write(canvas, "heading θ′", palette.text_2, WIDTH - COLUMN, top, CAPTION)
    images.paste(canvas, heading_histogram(layer, palette, (270, COLUMN)), WIDTH - COLUMN, top + 32)
    return canvas


def view_strip(active: int, views: int, recent: tuple[int, ...], palette: Palette) -> images.Pixels:
    """A square for each view (or for several neighbours), lit while active and fading for a while after."""
    rows, columns = STRIP_HW
    count, side = rows * columns, WIDTH // columns
    ground = mix(palette.panel, palette.text_2, 0.16)
    squares = np.tile(np.array(mix(palette.panel, palette.text_2, 0.05), np.uint8), (count, 1))
    per_square = max(1, -(-views // count))
    squares[: -(-views // per_square)] = ground
    for age, view in zip(range(len(recent), 0, -1), recent, strict=True):
        squares[min(view // per_square, count - 1)] = mix(palette.packets[0], ground, age / (RECENT + 1))
    if active >= 0:
        squares[min(active // per_square, count - 1)] = palette.robot
    large = np.repeat(np.repeat(squares.reshape(rows, columns, 3), side, 0), side, 1)
    large[side - 2 :: side], large[side - 1 :: side] = palette.panel, palette.panel
    large[:, side - 2 :: side], large[:, side - 1 :: side] = palette.panel, palette.panel
    return large


def from_above(layer: PoseCellLayer, palette: Palette, side: int) -> images.Pixels:
    """The activity summed over theta', front row at the bottom, each cell in its packet's colour."""
    _, n_y, n_x = layer.shape
    ground = np.array(mix(palette.panel, palette.text_2, 0.12), np.float64)
    light = np.zeros((n_y, n_x, 3))
    weight = np.zeros((n_y, n_x, 1))
    colours = np.array(palette.packets, np.float64)[np.minimum(CellFit(layer.shape).owners(layer), 3)]
    at = (layer.cells[:, 1], layer.cells[:, 2])
    np.add.at(light, at, colours * layer.activity[:, None])
    np.add.at(weight, at, layer.activity[:, None])
    share = np.sqrt(weight / max(float(weight.max()), 1e-9))
    small = ground * (1 - share) + light / np.maximum(weight, 1e-12) * share
    return cv2.resize(small[::-1].astype(np.uint8), (side, side), interpolation=cv2.INTER_NEAREST)


def heading_histogram(layer: PoseCellLayer, palette: Palette, size_hw: tuple[int, int]) -> images.Pixels:
    """The activity summed over x' and y', a bar for each layer of theta', 0 to 360 degrees."""
    height, width = size_hw
    canvas = np.empty((height, width, 3), np.uint8)
    canvas[:] = mix(palette.panel, palette.text_2, 0.12)
    n_theta, floor = layer.shape[0], height - 34
    bars = np.bincount(layer.cells[:, 0], weights=layer.activity, minlength=n_theta)
    tall = np.round(bars / max(float(bars.max(initial=0.0)), 1e-9) * (floor - 10)).astype(int)
    edges = np.linspace(0, width, n_theta + 1).round().astype(int)
    for k in range(n_theta):
        canvas[floor - tall[k] : floor, edges[k] : max(edges[k] + 1, edges[k + 1] - 2)] = palette.packets[0]
    canvas[floor : floor + 2] = palette.text_2
    for words, share in (("0°", 0.01), ("180°", 0.41), ("360°", 0.78)):
        images.write(canvas, words, palette.text_2, int(share * width), floor + 6, 20)
    return canvas


def _blank(height: int, palette: Palette) -> images.Pixels:
    canvas = np.empty((height, WIDTH, 3), np.uint8)
    colour: Rgb = palette.panel
    canvas[:] = colour
    return canvas

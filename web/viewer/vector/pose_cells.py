"""The pose cells from above as a vector picture: of each column the activity of all its layers, and the packets."""

from __future__ import annotations

import math

import numpy as np

from web.cell_owners import owners
from web.messages import PoseCellLayer, Snap
from web.viewer.primitives.palette import Palette
from web.viewer.vector.lesson import draw_cell_marks
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

LEAST_SHARE = 0.005  # a packet with less would show as 0 %
FAINTEST = 0.08
GRID = 16  # lines each way


def draw_pose_cells(subject: Subject) -> str:
    layer, palette = subject.snapshot.pose_cells, subject.palette
    n_theta, n_y, n_x = layer.shape
    words = f"where the network believes the robot is: {n_x} x {n_y} places, {n_theta} headings, seen from above"
    sheet = subject.sheet("Pose cells", words, (-0.5, -0.5, n_x - 0.5, n_y - 0.5))
    for k in range(1, GRID):
        x, y = n_x * k / GRID - 0.5, n_y * k / GRID - 0.5
        sheet.lines([[(x, -0.5), (x, n_y - 0.5)], [(-0.5, y), (n_x - 0.5, y)]], palette.grid, 1.0)
    _draw_activity(sheet, layer, palette)
    _draw_path(sheet, layer, palette)
    legend: list[Entry] = [("line", palette.packet_path, "where the strongest packet was in the last two minutes")]
    for packet in layer.packets[:4]:
        if packet.mass >= LEAST_SHARE:
            sheet.avoid((packet.x, packet.y), 13)
            sheet.dot((packet.x, packet.y), 13, None, palette.text)
            reach = 26 / sheet.scale
            tip = packet.x + reach * math.cos(packet.heading_rad), packet.y + reach * math.sin(packet.heading_rad)
            sheet.line([(packet.x, packet.y), tip], palette.text, 3)
    if layer.last_snap is not None:
        _draw_snap(sheet, layer.last_snap, palette)
        legend.append(("dashes", palette.goal, "from S to F: the last snap"))
    for k, packet in enumerate(layer.packets[:4]):
        if packet.mass >= LEAST_SHARE:
            words = f"{packet.id}: {packet.mass:.0%}"
            sheet.label((packet.x, packet.y), words, palette.on_packet, size=18, up=40, fill=palette.packets[k])
    draw_cell_marks(sheet, subject)
    sheet.foot(subject.moment, f"{layer.active_cells} cells are active; a cell is {layer.cell_m:g} m wide")
    sheet.legend(legend)
    return sheet.svg()


def _draw_activity(sheet: Sheet, layer: PoseCellLayer, palette: Palette) -> None:
    """A square a column, in the colour of the packet that most of its activity belongs to; brightness by its root."""
    sums: dict[tuple[int, int], np.ndarray] = {}
    for (_, y, x), amount, owner in zip(
        layer.cells.tolist(), layer.activity.tolist(), np.minimum(owners(layer), 3).tolist(), strict=True
    ):
        sums.setdefault((x, y), np.zeros(4))[owner] += amount
    most = max((float(each.sum()) for each in sums.values()), default=1.0)
    for (x, y), each in sums.items():
        corners = [(x - 0.5, y - 0.5), (x + 0.5, y - 0.5), (x + 0.5, y + 0.5), (x - 0.5, y + 0.5)]
        share = max(FAINTEST, math.sqrt(float(each.sum()) / most))
        sheet.polygon(corners, palette.voxels[int(each.argmax())], opacity=share)


def _draw_path(sheet: Sheet, layer: PoseCellLayer, palette: Palette) -> None:
    """The winner's path; it breaks where it goes round the torus."""
    _, n_y, n_x = layer.shape
    path = np.asarray(layer.path, np.float64).reshape(-1, 3)[:, :2]
    path = (path + 0.5) % (n_x, n_y) - 0.5
    if len(path) < 2:
        return
    jumps = (np.abs(np.diff(path, axis=0)) > np.array([n_x, n_y]) / 2).any(1)
    for part in np.split(path, np.flatnonzero(jumps) + 1):
        sheet.line(part, palette.packet_path, 2.0, opacity=0.75)


def _draw_snap(sheet: Sheet, snap: Snap, palette: Palette) -> None:
    start, end = (snap.start.x, snap.start.y), (snap.end.x, snap.end.y)
    sheet.line([start, end], palette.goal, 2.5, dash="7 6")
    for place, letter in ((start, "S"), (end, "F")):
        sheet.dot(place, 10, palette.goal)
        sheet.avoid(place, 10)
        sheet.label(place, letter, palette.on_goal, up=-26, fill=palette.goal)

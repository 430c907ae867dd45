"""The pose cells from above as a vector picture: of each column the activity of all its layers, the packets, what is below."""

from __future__ import annotations

import math

import numpy as np

from web.messages import GoalMemoryLayer, PoseCellLayer, Snap
from web.messages.robot_status import packet_words, share_words
from web.viewer.plates.pose_cell_plate import BELIEVES, LEAST_SHARE, NO_ACTIVITY, PACKETS, metres_words
from web.viewer.primitives.palette import Palette
from web.viewer.vector.layers import draw_beneath, draw_cell_marks, mark_among_cells
from web.viewer.vector.sheet import Entry, Sheet
from web.viewer.vector.subject import Subject

FAINTEST = 0.08
GRID = 16  # lines each way
PACKET, TIP = 13.0, 26.0  # pixels: of the ring, and from its middle to the end of the line that is the heading
WAY = 70.0  # from there to the tip of the arrow


def draw_pose_cells(subject: Subject) -> str:
    layer, palette = subject.snapshot.pose_cells, subject.palette
    n_theta, n_y, n_x = layer.shape
    words = f"{BELIEVES}: {n_x} x {n_y} places, {n_theta} headings, seen from above"
    sheet = subject.sheet("Pose cells", words, (-0.5, -0.5, n_x - 0.5, n_y - 0.5))
    for k in range(1, GRID):
        x, y = n_x * k / GRID - 0.5, n_y * k / GRID - 0.5
        sheet.lines([[(x, -0.5), (x, n_y - 0.5)], [(-0.5, y), (n_x - 0.5, y)]], palette.grid, 1.0)
    beneath = draw_beneath(sheet, subject)
    _draw_activity(sheet, layer, palette)
    _draw_path(sheet, layer, palette)
    legend: list[Entry] = [("line", palette.packet_path, "where the strongest packet was in the last two minutes")]
    _draw_axes(sheet, layer)
    marked = mark_among_cells(sheet, subject)
    shown = [packet for packet in layer.packets[:PACKETS] if packet.mass >= LEAST_SHARE]
    for packet in shown:
        sheet.avoid((packet.x, packet.y), PACKET)
        sheet.dot((packet.x, packet.y), PACKET, None, palette.text)
        reach = TIP / sheet.scale
        tip = packet.x + reach * math.cos(packet.heading_rad), packet.y + reach * math.sin(packet.heading_rad)
        sheet.line([(packet.x, packet.y), tip], palette.text, 3)
    if subject.overlaid.goal_memory is not None:
        legend += _draw_way(sheet, layer, subject.overlaid.goal_memory, palette)
    if layer.last_snap is not None:
        _draw_snap(sheet, layer.last_snap, palette)
        legend.append(("dashes", palette.goal, "from S to F: the last snap"))
    for packet, colour in zip(shown, palette.packets, strict=False):
        words = packet_words(packet.id, packet.mass, len(shown) == 1)
        sheet.label((packet.x, packet.y), words, palette.on_packet, size=18, up=40, fill=colour)
    for other in subject.others:
        if other.cells is not None:
            x, y, _ = other.cells
            at = (x + 0.5) % n_x - 0.5, (y + 0.5) % n_y - 0.5
            sheet.dot(at, PACKET, None, palette.robot)
            sheet.label(at, share_words(other.share), palette.text, size=14, up=24)
    if any(other.cells for other in subject.others):
        legend.append(("ring", palette.robot, "where it may be instead, and how likely"))
    if not len(layer.cells):
        sheet.label(((n_x - 1) / 2, (n_y - 1) / 2), NO_ACTIVITY, palette.text_2)
    draw_cell_marks(sheet, subject)
    sheet.foot(subject.moment, f"{layer.active_cells} cells are active; a cell is {layer.cell_m:g} m wide")
    sheet.legend(legend + marked + beneath)
    return sheet.svg()


def _draw_axes(sheet: Sheet, layer: PoseCellLayer) -> None:
    """x' along the lower edge and y' along the left one, in metres."""
    x1, y1, x2, y2 = sheet.box
    _, n_y, n_x = layer.shape
    for share, anchor in ((0.5, "middle"), (1.0, "end")):
        words = metres_words(share * n_x * layer.cell_m, share == 1.0)
        sheet.note((x1 + share * (x2 - x1) - 6 * (share == 1.0) / sheet.scale, y1), words, anchor=anchor, up=8)
    for share, up in ((0.5, -5.0), (1.0, -18.0)):
        words = metres_words(share * n_y * layer.cell_m, share == 1.0)
        sheet.note((x1 + 6 / sheet.scale, y1 + share * (y2 - y1)), words, anchor="start", up=up)
    sheet.note((x1 + 6 / sheet.scale, y1), "0", anchor="start", up=8)
    sheet.note((x1 + 0.75 * (x2 - x1), y1), "x′", anchor="middle", up=8, bold=True)
    sheet.note((x1 + 6 / sheet.scale, y1 + 0.75 * (y2 - y1)), "y′", anchor="start", up=-5, bold=True)


def _draw_activity(sheet: Sheet, layer: PoseCellLayer, palette: Palette) -> None:
    """A square a column, in the colour of the packet that most of its activity belongs to; brightness by its root."""
    sums: dict[tuple[int, int], np.ndarray] = {}
    for (_, y, x), amount, owner in zip(
        layer.cells.tolist(), layer.activity.tolist(), np.minimum(layer.owners(), PACKETS - 1).tolist(), strict=True
    ):
        sums.setdefault((x, y), np.zeros(PACKETS))[owner] += amount
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


def _draw_way(sheet: Sheet, layer: PoseCellLayer, goal: GoalMemoryLayer, palette: Palette) -> list[Entry]:
    """A ring at the goal's cell; an arrow from the packet in the direction in which the times to the goal fall fastest."""
    legend: list[Entry] = []
    if goal.goal is not None:
        for colour, edge in ((palette.casing, 7.0), (palette.goal, 4.0)):
            sheet.dot(goal.goal, 11, None, colour, edge=edge)
        sheet.avoid(goal.goal, 12)
        legend.append(("ring", palette.goal, "the goal in the goal memory; the arrow: the quickest way there"))
    if goal.direction_rad is not None and layer.packets:
        here = np.array([layer.packets[0].x, layer.packets[0].y])
        ahead = np.array([math.cos(goal.direction_rad), math.sin(goal.direction_rad)])
        way = here + np.array([[TIP + 4], [WAY - 14]]) / sheet.scale * ahead
        sheet.way(way, palette.goal, 5.0)
        sheet.avoid(way[1].tolist(), PACKET)
    return legend


def _draw_snap(sheet: Sheet, snap: Snap, palette: Palette) -> None:
    start, end = (snap.start.x, snap.start.y), (snap.end.x, snap.end.y)
    sheet.line([start, end], palette.goal, 2.5, dash="7 6")
    for place, letter in ((start, "S"), (end, "F")):
        sheet.dot(place, 10, palette.goal)
        sheet.avoid(place, 10)
        sheet.label(place, letter, palette.on_goal, up=-26, fill=palette.goal)

"""Walls, partitions, desks, posters, doors and windows of an office, and the floor with their shadows."""

from __future__ import annotations

import math

import numpy as np
import viser
from numpy.typing import NDArray

from web.messages import WorldDrawing
from web.stage import images, ribbons
from web.stage.office_fit import OfficeFit
from web.stage.palette import Palette, Rgb, mix
from web.stage.sight import inside, solid_runs
from web.stage.signs import add_mesh, add_picture

Array = NDArray[np.float64]
FLOOR_PX_PER_UNIT = 96
HEIGHTS = {"wall": 0.62, "partition": 0.42, "desk": 0.24}
FRONT = 0.18
METRE_HIGH = 0.62 / 2.5  # plate units of height for a metre of any other thing, or of a panel
PANEL_THICK = 0.11  # stands out from a wall on its own side
THICK = {"wall": 0.1, "partition": 0.07, "glass": 0.03}
GLASS_RGB: Rgb = (150, 200, 225)


def add_floor(
    scene: viser.SceneApi, name: str, palette: Palette, world: WorldDrawing, fit: OfficeFit, z: float
) -> None:
    """The floor image: metre grid, contact shadows and the names of places."""
    px = FLOOR_PX_PER_UNIT * fit.scale
    floor = images.gridded_floor(fit.size_m, px, palette.floor, palette.grid, 1.0 if fit.scale > 0.35 else 5.0)
    height = floor.shape[0]

    def pixels(xy: Array) -> Array:
        return np.column_stack([(xy[:, 0] - fit.low[0]) * px, height - (xy[:, 1] - fit.low[1]) * px])

    walls = np.asarray(world.walls, np.float64)
    for corners in world.slow_zones:
        floor = images.tint(floor, pixels(np.asarray(corners, np.float64)), palette.packets[0], 0.22)
    lines = np.hstack([pixels(walls[:, :2]), pixels(walls[:, 2:])]) if len(walls) else walls
    solids = [pixels(outline) for _, outline in solid_runs(world)]
    floor = images.contact_shadow(floor, lines, solids, 0.16 * FLOOR_PX_PER_UNIT * fit.relief, palette.shadow)
    ink = mix(palette.floor, palette.text_2, 0.6)
    for words, x, y in world.places:
        left, middle = pixels(np.array([[x, y]]))[0]
        label = images.text(words, ink, 26)
        images.paste(floor, label, max(0, int(left - label.shape[1] / 2)), max(0, int(middle - 15)))
    add_picture(
        scene,
        name,
        floor,
        fit.size_m[0] * fit.scale,
        fit.size_m[1] * fit.scale,
        position=(0.0, 0.0, z),
        format="jpeg",
        jpeg_quality=92,
    )


def add_furniture(scene: viser.SceneApi, name: str, palette: Palette, world: WorldDrawing, fit: OfficeFit) -> None:
    """One batch of boxes for walls and panels, one mesh for the closed outlines."""
    runs = solid_runs(world)
    closed = {row for rows, _ in runs for row in rows}
    panes = [row for row in range(len(world.walls)) if world.wall_kind[row] == "glass"]
    _add_glass(scene, f"{name}_glass", [_wall_box(world, fit, row, palette) for row in panes])
    closed.update(panes)
    boxes = [_wall_box(world, fit, row, palette) for row in range(len(world.walls)) if row not in closed]
    boxes += [_panel_box(world, fit, row) for row in range(len(world.panels))]
    middles = (world.panels[:, :2] + world.panels[:, 2:4]) / 2
    for rows, outline in runs:
        bare = not any(inside(outline, float(x), float(y)) for x, y in middles)
        if world.wall_kind[rows[0]] == "desk" and bare:
            boxes += _screens(fit, outline, palette)
    boxes = [box for box in boxes if box is not None] or [((0, 0, -50), (1, 1, 1), 0.0, palette.wall)]
    centres, sizes, turns, colours = zip(*boxes, strict=True)
    turn = np.array(turns) / 2
    scene.add_batched_meshes_simple(
        f"{name}_boxes",
        *ribbons.sharp(ribbons.UNIT_CUBE),
        batched_wxyzs=np.column_stack([np.cos(turn), 0 * turn, 0 * turn, np.sin(turn)]).astype(np.float32),
        batched_positions=np.array(centres, np.float32),
        batched_scales=np.array(sizes, np.float32),
        batched_colors=palette.batched(colours),
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
    )
    for kind in ("desk", "other"):
        chosen = [
            ribbons.extruded(fit.to_plate(outline), 0.0, _height(world, rows[0]) * fit.relief)
            for rows, outline in runs
            if (world.wall_kind[rows[0]] == "desk") == (kind == "desk") and world.wall_kind[rows[0]] != "glass"
        ]
        colour = palette.lit(palette.desk if kind == "desk" else palette.partition)
        add_mesh(scene, f"{name}_{kind}", ribbons.joined(*chosen) if chosen else ribbons.NOTHING, colour)


def _add_glass(scene: viser.SceneApi, name: str, panes: list[Box]) -> None:
    """What one sees through: light blue, in one mesh."""
    solid = [ribbons.turned_box(*pane[:3]) for pane in panes]
    add_mesh(scene, name, ribbons.joined(*solid) if solid else ribbons.NOTHING, GLASS_RGB, opacity=0.35)


Box = tuple[tuple[float, float, float], tuple[float, float, float], float, Rgb]  # centre, size, turn, colour


def _height(world: WorldDrawing, row: int) -> float:
    kind = world.wall_kind[row]
    return HEIGHTS.get(kind, min(max(float(world.wall_height_m[row]) * METRE_HIGH, 0.1), 0.62))


def _wall_box(world: WorldDrawing, fit: OfficeFit, row: int, palette: Palette) -> Box:
    """Outer walls stand outside the bounds, and the front one is low, so that one can look in."""
    x1, y1, x2, y2 = (float(v) for v in world.walls[row])
    side = _outer_side(world, x1, y1, x2, y2)
    kind = world.wall_kind[row]
    thick = THICK.get(kind, 0.08) * fit.relief
    height = (FRONT if side == (0.0, -1.0) else _height(world, row)) * fit.relief
    (ax, ay), (bx, by) = fit.to_plate(np.array([[x1, y1], [x2, y2]]))
    centre = ((ax + bx) / 2 + side[0] * thick / 2, (ay + by) / 2 + side[1] * thick / 2, height / 2)
    length = math.dist((ax, ay), (bx, by)) + (2 * thick if side[1] else 0.0)
    colour = {"wall": palette.wall, "desk": palette.desk}.get(kind, palette.partition)
    return centre, (length, thick, height), math.atan2(by - ay, bx - ax), colour


def _outer_side(world: WorldDrawing, x1: float, y1: float, x2: float, y2: float) -> tuple[float, float]:
    """Outwards for a wall that lies on the bounds, else (0, 0)."""
    low_x, low_y, high_x, high_y = world.bounds
    for value, bound, side in ((x1, low_x, (-1.0, 0.0)), (x1, high_x, (1.0, 0.0))):
        if abs(value - bound) < 0.06 and abs(x2 - x1) < 0.06:
            return side
    for value, bound, side in ((y1, low_y, (0.0, -1.0)), (y1, high_y, (0.0, 1.0))):
        if abs(value - bound) < 0.06 and abs(y2 - y1) < 0.06:
            return side
    return 0.0, 0.0


def _panel_box(world: WorldDrawing, fit: OfficeFit, row: int) -> Box | None:
    """A poster, door or window: a thin box that stands out from its wall. None on the low front wall."""
    x1, y1, x2, y2, bottom, top = (float(v) for v in world.panels[row])
    if _outer_side(world, x1, y1, x2, y2) == (0.0, -1.0):
        return None
    low, high = max(bottom * METRE_HIGH, 0.0) * fit.relief, min(top * METRE_HIGH, 0.6) * fit.relief
    (ax, ay), (bx, by) = fit.to_plate(np.array([[x1, y1], [x2, y2]]))
    red, green, blue = (int(v) for v in world.panel_rgb[row])
    return (
        ((ax + bx) / 2, (ay + by) / 2, (low + high) / 2),
        (math.dist((ax, ay), (bx, by)), PANEL_THICK * fit.relief, max(high - low, 0.02)),
        math.atan2(by - ay, bx - ax),
        (red, green, blue),
    )


def _screens(fit: OfficeFit, outline: Array, palette: Palette) -> list[Box]:
    """A dark screen on each desk, so that desks read as desks."""
    corners = fit.to_plate(outline)
    low, high = corners.min(0), corners.max(0)
    if min(high - low) < 0.3:
        return []
    x, y = (low + high) / 2
    return [((float(x), float(y), HEIGHTS["desk"] + 0.02), (0.34, 0.2, 0.04), 0.0, palette.tyre)]

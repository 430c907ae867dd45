from __future__ import annotations

import numpy as np
import pytest

from sim2d import Panel, Wall, draw_world, load_world, world_names
from sim2d.world.texture import TEXTURES, paint_strip, strip_shape

from .rooms import GREY, room


def panel(texture: str, side: str = "left", seed: int = 1, colour: tuple[int, int, int] = (200, 120, 40)) -> Panel:
    return Panel(0.5, 0.8, 0.3, 1.5, texture, colour, seed, side)


def test_panels_hang_on_their_side() -> None:
    wall = Wall(0, 1, 2, 1, "partition", 1.6, GREY, panels=(panel("paint", "both"), panel("door", "right")))
    screen = Wall(1, 3, 1.5, 3, "screen", 1.2, (20, 20, 24), bottom=0.8)
    drawing = draw_world(room(wall, screen))
    assert drawing.walls.shape == (5, 4)
    assert drawing.wall_kind == ("wall",) * 4 + ("partition",)
    assert drawing.wall_height_m[4] == pytest.approx(1.6)
    left, right, door, lit = drawing.panels
    assert left == pytest.approx([0.5, 1.01, 1.3, 1.01, 0.3, 1.5])
    assert right[1] == door[1] == pytest.approx(0.99)
    assert lit == pytest.approx([1.0, 3.0, 1.5, 3.0, 0.8, 1.2])
    assert drawing.panel_rgb[0].tolist() == [200, 120, 40]
    assert not drawing.walls.flags.writeable


def test_a_world_without_panels() -> None:
    assert draw_world(room()).panels.shape == (0, 6)
    assert draw_world(room()).panel_rgb.shape == (0, 3)


@pytest.mark.parametrize("name", [name for name, _ in world_names()])
def test_arrays_of_shipped_worlds(name: str) -> None:
    drawing = draw_world(load_world(name))
    assert len(drawing.panels) == len(drawing.panel_rgb)
    assert np.isfinite(drawing.walls).all()
    assert (drawing.panels[:, 5] > drawing.panels[:, 4]).all()


@pytest.mark.parametrize("texture", TEXTURES)
@pytest.mark.parametrize("height", [0.2, 2.6])
def test_every_texture_at_every_size(texture: str, height: float) -> None:
    top = min(1.5, height)
    hung = Panel(0.995, 0.005, 0.05, top, texture, (30, 30, 40), 5, "left")
    wide = Panel(0.1, 0.85, 0.05, top, texture, (230, 220, 200), 6, "left")
    wall = Wall(0, 0, 1, 0, "wall", height, GREY, panels=(hung, wide))
    strip = paint_strip(wall, "left")
    assert strip.shape == (*strip_shape(wall), 3)
    assert strip.min() >= 0
    assert strip.max() <= 255
    assert np.array_equal(strip, paint_strip(wall, "left"))
    assert not np.array_equal(strip, paint_strip(wall, "right"))


def test_seeds_make_different_posters() -> None:
    one, two = (Wall(0, 0, 2, 0, "wall", 2.6, GREY, panels=(panel("poster", seed=s),)) for s in (1, 2))
    assert np.abs(paint_strip(one, "left") - paint_strip(two, "left")).mean() > 1


def test_sides_differ_only_where_they_are_told_to() -> None:
    wall = Wall(0, 0, 2, 0, "partition", 1.6, GREY, panels=(panel("poster", "both"),))
    assert np.array_equal(paint_strip(wall, "left"), paint_strip(wall, "right"))

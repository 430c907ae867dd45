"""What the page draws of a world, and what hangs on its walls."""

from __future__ import annotations

import numpy as np
import pytest

from sim2d import Panel, draw_world
from sim2d.world.texture import TEXTURES, paint_strip, strip_shape

from .rooms import room, wall


def panel(texture: str, side: str = "left", seed: int = 1) -> Panel:
    return Panel(0.5, 0.8, 0.3, 1.5, texture, (200, 120, 40), seed, side)


def test_panels_hang_on_their_side() -> None:
    hung = wall(0, 1, 2, 1, kind="partition", height=1.6, panels=(panel("paint", "both"), panel("door", "right")))
    screen = wall(1, 3, 1.5, 3, kind="screen", height=1.2, colour=(20, 20, 24), bottom=0.8)
    drawing = draw_world(room(hung, screen))
    assert drawing.walls.shape == (5, 4)
    assert drawing.wall_kind == ("wall",) * 4 + ("partition",)
    assert drawing.wall_height_m[4] == pytest.approx(1.6)
    left, right, door, lit = drawing.panels
    assert left == pytest.approx([0.5, 1.01, 1.3, 1.01, 0.3, 1.5])
    assert right[1] == door[1] == pytest.approx(0.99)
    assert lit == pytest.approx([1.0, 3.0, 1.5, 3.0, 0.8, 1.2])
    assert drawing.panel_rgb[0].tolist() == [200, 120, 40]
    assert not drawing.walls.flags.writeable
    bare = draw_world(room())
    assert (bare.panels.shape, bare.panel_rgb.shape) == ((0, 6), (0, 3))


def test_every_texture_at_every_size(subtests: pytest.Subtests) -> None:
    for texture, height in ((texture, height) for texture in TEXTURES for height in (0.2, 2.6)):
        with subtests.test(f"{texture}, {height} m"):
            top = min(1.5, height)
            hung = Panel(0.995, 0.005, 0.05, top, texture, (30, 30, 40), 5, "left")
            wide = Panel(0.1, 0.85, 0.05, top, texture, (230, 220, 200), 6, "left")
            each = wall(0, 0, 1, 0, height=height, panels=(hung, wide))
            strip = paint_strip(each, "left")
            assert strip.shape == (*strip_shape(each), 3)
            assert 0 <= strip.min() <= strip.max() <= 255
            assert np.array_equal(strip, paint_strip(each, "left"))
            assert not np.array_equal(strip, paint_strip(each, "right"))


def test_posters_differ_by_their_seeds_and_sides_only_where_they_are_told_to() -> None:
    one, two = (wall(0, 0, 2, 0, panels=(panel("poster", seed=seed),)) for seed in (1, 2))
    assert np.abs(paint_strip(one, "left") - paint_strip(two, "left")).mean() > 1
    both = wall(0, 0, 2, 0, kind="partition", height=1.6, panels=(panel("poster", "both"),))
    assert np.array_equal(paint_strip(both, "left"), paint_strip(both, "right"))

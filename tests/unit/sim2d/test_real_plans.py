"""The importers on floor plans: of a building of our own, and of real ones if they lie beside the repository."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from sim2d import FreeSpace, World
from sim2d.geometry.segments import nearest_segment
from sim2d.importers import import_file
from sim2d.importers.picture_map import SPECK_PX, MapYaml, free_pixels, read_map_yaml, read_picture, without_slivers
from sim2d.importers.trace import choose_floor, ring_area, trace

OURS = Path(__file__).parents[2] / "data"
THEIRS = Path(__file__).parents[4] / "shared" / "data" / "worlds"
PICTURES = [
    (OURS / "building.yaml", None),
    (OURS / "drawing.png", 0.1),
    (THEIRS / "gdc_3ne/3ne.yaml", None),
    (THEIRS / "willow/willow-full.pgm", 0.1),
]
VECTORS = [OURS / "building.vectormap.json", THEIRS / "amrl/AHG2.vectormap.json", THEIRS / "amrl/NSH1.vectormap.json"]


def there(path: Path, scale_m: float | None = None) -> World:
    """The world of a plan, with places to start from."""
    if not path.is_file():
        pytest.skip(f"{path.name} is not there")
    world = import_file(path, scale_m)
    assert 100 < len(world.walls) <= 4000
    assert len(world.starts) == 4
    free, home = FreeSpace(world, 0.22), world.starts[0]
    assert all(20 < free.shortest_m((home.x, home.y), (s.x, s.y)) < 200 for s in world.starts[1:])
    return world


@pytest.mark.slow
@pytest.mark.parametrize(("path", "scale_m"), PICTURES, ids=lambda value: getattr(value, "name", None))
def test_walls_are_where_the_picture_has_them(path: Path, scale_m: float | None) -> None:
    """Both ways: every wall within 1.5 pixels of a pixel that is no floor, every border of the floor within 1.5 of a wall."""
    world = there(path, scale_m)
    if scale_m is None:
        about = read_map_yaml(path.name, path.read_text("utf-8"))
    else:
        about = MapYaml(path.name, scale_m, (0.0, 0.0, 0.0), False, 0.65, 0.196, "trinary")
    free = free_pixels(*read_picture(path.name, path.with_name(about.image).read_bytes()), about)[::-1]
    walls = (world.segments() - np.tile(about.origin[:2], 2)) / about.resolution

    points = np.concatenate([np.linspace(w[:2], w[2:], int(np.hypot(*(w[2:] - w[:2])) * 4) + 2) for w in walls])
    rows, columns = np.nonzero(~np.pad(free, 1))
    around = cKDTree(np.column_stack([columns, rows]) - 0.5)  # centres of pixels; the padding is one pixel
    _, near = around.query(points, k=6)
    off = np.maximum(np.abs(around.data[near] - points[:, None]) - 0.5, 0.0)  # from their edges
    assert np.hypot(off[..., 0], off[..., 1]).min(axis=1).max() <= 1.5

    floor = choose_floor(path.name, without_slivers(free, about.resolution), about.resolution, 0.22).mask
    rings = [r for r in trace(floor) if ring_area(r) > 0 or -ring_area(r) >= SPECK_PX]
    middles = [(a + b) / 2 for ring in rings for a, b in pairwise(ring.astype(float))][::3]
    away = [nearest_segment(walls, x, y)[1] for x, y in middles]
    assert max(away) <= 1.5 + 0.03  # walls lie at whole millimetres


@pytest.mark.slow
@pytest.mark.parametrize("path", VECTORS, ids=lambda path: path.name)
def test_vector_maps_are_taken_as_they_are(path: Path) -> None:
    world = there(path)
    given = json.loads(path.read_text("utf-8"))
    inner = [w for w in world.walls if not w.outer]
    assert len(inner) == len(given)  # none of them without length
    first = given[0]
    assert (inner[0].x1, inner[0].y2) == (round(first["p0"]["x"], 3), round(first["p1"]["y"], 3))

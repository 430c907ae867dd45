"""Lists of segments become worlds, and world files are let through."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim2d import WorldError, world_to_json
from sim2d.importers import import_file, import_world, open_world

from .plans import from_picture, room

SQUARE = [[0, 0, 6, 0], [6, 0, 6, 5], [6, 5, 0, 5], [0, 5, 0, 0]]


@pytest.mark.parametrize(
    "form",
    [
        lambda s: s,
        lambda s: [[k[:2], k[2:]] for k in s],
        lambda s: [{"p0": {"x": k[0], "y": k[1]}, "p1": {"x": k[2], "y": k[3]}} for k in s],
    ],
)
def test_vector_maps(form) -> None:
    text = json.dumps(form([*SQUARE, [1, 1, 1, 1]]))
    world = import_world("v.json", {"v.json": text.encode()})
    inner = {(w.x1, w.y1, w.x2, w.y2) for w in world.walls if not w.outer}
    assert inner == {tuple(map(float, k)) for k in SQUARE}
    assert all(0.22 < s.x < 5.78 and 0.22 < s.y < 4.78 for s in world.starts)  # not in the strip around


def test_a_world_file_is_let_through(tmp_path: Path) -> None:
    world = from_picture(room())
    path = tmp_path / "room.json"
    path.write_text(world_to_json(world), "utf-8")
    assert import_file(path) == open_world(path) == world
    assert open_world("office").name == "office"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[]", "v.json: 0 segments, none of them"),
        ("[[0, 0, 0, 0]]", "1 segments, none of them 0.01 m long"),
        ("[[0, 0, 5, 0],\n [0, 0, 5]]", r"v.json: \[1\]: got \[0, 0, 5\]; must be .*\(line 2\)"),
        ('[[0, 0, 5, "a"]]', r"\[0\]: got"),
        ("[[0, 0, 5, NaN]]", r"\[0\]: got .*finite"),
        ("[[0, 0, 5, true]]", r"\[0\]: got"),
        ("[[0, 0, 5, 1e99]]", r"\[0\]: got"),
        ("[[0, 0, 9000, 0]]", "spans 9001 by 1 m; at most"),
        ("[[0, 0, 5, 0]", "v.json: not JSON: line 1, column 14"),
        ("{}", "an object with keys none; expected a world file"),
        ('{"edges": [], "nodes": []}', "an object with keys edges, nodes; expected a world file"),
        ('{"format": 1}', "v.json: name: field required"),
        ("[" * 100_000, "nested too deeply"),
        ("[" * 100 + "]" * 100, "v.json: not a world: nested too deeply; at most 20"),
        ("[[0, 0, 5, 1" + "0" * 400 + "]]", r"\[0\]: got"),
        ("[[0, 0, 5, 1" + "0" * 5000 + "]]", "v.json: a number has thousands of digits"),
        ('{"\\ud800": 1}', r"an object with keys \\ud800; expected"),
        ("7", "v.json: "),
        (json.dumps(SQUARE * 2501), "10004 segments; at most 10000"),
        (" " * 1_000_001, "v.json: 1000001 bytes; at most 1000000"),
    ],
)
def test_bad_vector_maps(text: str, complaint: str) -> None:
    with pytest.raises(WorldError, match=complaint):
        import_world("v.json", {"v.json": text.encode()})

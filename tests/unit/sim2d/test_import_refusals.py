"""Plans that are lists of segments become worlds; files that cannot be imported are refused with file, line, value and what
is right."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sim2d import WorldError, world_to_json
from sim2d.importers import import_file, import_world, open_world

from .plans import YAML, from_picture, pgm, room

MAP = {"m.yaml": YAML.encode(), "plan.pgm": pgm(room())}
SQUARE = [[0, 0, 6, 0], [6, 0, 6, 5], [6, 5, 0, 5], [0, 5, 0, 0]]


def yaml_with(old: str, new: str) -> dict[str, bytes]:
    return {**MAP, "m.yaml": YAML.replace(old, new).encode()}


BAD_MAPS: tuple[tuple[dict[str, bytes], str], ...] = (
    (yaml_with("resolution: 0.05\n", ""), "m.yaml: resolution is missing"),
    (yaml_with("0.05", "0"), r"m.yaml: line 2: resolution: got 0; must be from 0.001 to 1 metres"),
    (yaml_with("0.05", "-0.05"), r"line 2: resolution: got -0.05; must be from"),
    (yaml_with("0.05", "5e3"), r"line 2: resolution: got 5e3; must be from"),
    (yaml_with("0.05", "nan"), r"line 2: resolution: got nan; must be from"),
    (yaml_with("0.05", "coarse"), r"line 2: resolution: got 'coarse'; must be a number"),
    (yaml_with("[0, 0, 0]", "[0, 0]"), r"line 3: origin: got \[0, 0\]; must be \[x, y, yaw\]"),
    (yaml_with("[0, 0, 0]", "[0, 1e9, 0]"), r"line 3: origin: got .*within 9000 m"),
    (yaml_with("negate: 0", "negate: 0.5"), r"line 4: negate: got 0.5; must be 0 or 1"),
    (yaml_with("0.196", "0.7"), r"line 6: free_thresh: got 0.7; must be below occupied_thresh, 0.65"),
    (yaml_with("negate: 0", "negate: 0\nmode: fancy"), r"line 5: mode: got 'fancy'; expected one of: trinary"),
    (yaml_with("negate", "negated"), r"m.yaml: negate is missing; .*, and not 'negated'"),
    (yaml_with("negate: 0", "negate: 0\nnegate: 1"), r"line 5: negate is there twice, first on line 4"),
    (yaml_with("negate: 0", "{a: !!python/object}"), r"line 4: not YAML: "),
    (yaml_with("plan.pgm", "../../etc/passwd"), r"image: 'passwd' was not given with it; put both together"),
    (yaml_with("plan.pgm", "..\\x.pgm"), r"'x.pgm' was not given"),
    (yaml_with("plan.pgm", ".."), r"line 1: image: got '..'; must name a picture"),
    (yaml_with("[0, 0, 0]", "&a [*a, *a]"), r"line 3: not YAML: an alias"),
    (yaml_with("[0, 0, 0]", "[" * 5000), r"not YAML: nested too deep"),
    ({"m.yaml": b"- a\n- b\n"}, r"line 1: expected one list of `key: value`"),
    (yaml_with("plan.pgm", "other.pgm"), r"'other.pgm' was not given with it"),
    ({"m.yaml": b"\xff\xfe"}, "m.yaml: not text: byte 0 is 0xff"),
    ({**MAP, "plan.pgm": b"P5\n10 10\n255\nshort"}, "plan.pgm: the picture is broken"),
    ({**MAP, "plan.pgm": b"hello"}, "plan.pgm: not a picture that can be read"),
    ({**MAP, "plan.pgm": b"P5\n90000 90000\n255\n"}, "plan.pgm: hundreds of millions of pixels; at most 16"),
    ({**MAP, "plan.pgm": b"P5\n9000 9000\n255\n"}, "plan.pgm: 9000 x 9000 pixels; at most 16"),
    ({**MAP, "plan.pgm": b"P5\n2 2\n65535\n" + bytes(8)}, "more than 8 bits"),
    ({"m.yaml": YAML.encode() + b"#" * 70_000}, "m.yaml: 70102 bytes; at most 65536"),
    (yaml_with("image: plan.pgm", "image: plan.pgm\nrobot"), "line 3: not YAML"),
)  # fmt: skip
BAD_SEGMENTS = (
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
)  # fmt: skip
BAD_PICTURES = (
    (room(), None, "plan.pgm: a plain picture needs its scale"),
    (room(), 0.0, "got a scale of 0; must be from 0.001 to 1 m a pixel"),
    (room(), -1.0, "got a scale of -1; must be"),
    (room(), math.nan, "got a scale of nan; must be"),
    (room(), 1e9, "got a scale of 1e\\+09; must be"),
    (np.zeros((40, 40), np.uint8), 0.05, "no pixel is floor"),
    (room(), 0.002, r"no place where a robot of 0.22 m radius fits: the widest is 0.22 m"),
    (np.full((40, 40), 180, np.uint8), 0.05,
     "no pixel is floor: .*column 0 of row 0, has grey 180; floor is light, .* below 0.196"),
    (np.zeros((0, 0), np.uint8), 0.05, "plan.pgm: the picture is broken|not a picture"),
)  # fmt: skip


def test_what_cannot_be_imported_says_what_is_wrong(subtests: pytest.Subtests) -> None:
    cases = [("m.yaml", files, None, complaint) for files, complaint in BAD_MAPS]
    cases += [("v.json", {"v.json": text.encode()}, None, complaint) for text, complaint in BAD_SEGMENTS]
    cases += [("plan.pgm", {"plan.pgm": pgm(picture)}, scale, complaint) for picture, scale, complaint in BAD_PICTURES]
    cases += [
        ("plan.txt", {"plan.txt": b""}, None, r"plan.txt: cannot be imported; expected .json"),
        ("x.json", {}, None, r"x.json: is not among the files given: none"),
        ("m.yaml", MAP, 0.05, "only plain pictures take one"),
    ]
    for name in ("plan.svg", "plan.pdf", "plan.DWG"):
        cases.append((name, {name: b"<svg/>"}, None, r"a drawing in \w+ is not read; .* as PNG"))
    for name, files, scale_m, complaint in cases:
        with subtests.test(complaint), pytest.raises(WorldError, match=complaint):
            import_world(name, files, scale_m)


def test_files_on_the_disk_and_worlds_by_their_names(tmp_path: Path) -> None:
    path = tmp_path / "m.yaml"
    path.write_text(YAML, "utf-8")
    with pytest.raises(WorldError, match=r"m.yaml: image: got 'plan.pgm', but there is no file 'plan.pgm'"):
        import_file(path)
    (tmp_path / "plan.pgm").write_bytes(MAP["plan.pgm"])
    assert len(import_file(path).walls) == 4
    world = from_picture(room())
    (tmp_path / "room.json").write_text(world_to_json(world), "utf-8")
    assert import_file(tmp_path / "room.json") == open_world(tmp_path / "room.json") == world
    assert open_world("office").name == "office"
    with pytest.raises(WorldError, match="no world 'nowhere'"):
        open_world("nowhere")


def test_segments_are_walls_however_they_are_written() -> None:
    segments = [*SQUARE, [1, 1, 1, 1]]
    for form in (
        segments,
        [[k[:2], k[2:]] for k in segments],
        [{"p0": {"x": k[0], "y": k[1]}, "p1": {"x": k[2], "y": k[3]}} for k in segments],
    ):
        world = import_world("v.json", {"v.json": json.dumps(form).encode()})
        inner = {(w.x1, w.y1, w.x2, w.y2) for w in world.walls if not w.outer}
        assert inner == {tuple(map(float, k)) for k in SQUARE}
        assert all(0.22 < s.x < 5.78 and 0.22 < s.y < 4.78 for s in world.starts)  # not in the strip around

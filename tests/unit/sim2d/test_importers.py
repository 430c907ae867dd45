"""Importers tested with plans whose walls are known, and with files that strangers may send."""

from __future__ import annotations

import json
import math
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from sim2d import FreeSpace, World, WorldError, world_from_json, world_to_json
from sim2d.importers import import_file, import_world, open_world
from sim2d.importers.trace import ring_area, simplify, trace

YAML = "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def pgm(picture: NDArray[np.uint8]) -> bytes:
    return b"P5\n%d %d\n255\n" % (picture.shape[1], picture.shape[0]) + picture.astype(np.uint8).tobytes()


def png(picture: NDArray[np.uint8]) -> bytes:
    out = BytesIO()
    Image.fromarray(picture).save(out, "PNG")
    return out.getvalue()


def room(rows: int = 120, columns: int = 160, border: int = 5) -> NDArray[np.uint8]:
    picture = np.zeros((rows, columns), np.uint8)
    picture[border:-border, border:-border] = 255
    return picture


def from_picture(picture: NDArray[np.uint8], scale_m: float = 0.05, seed: int = 0) -> World:
    return import_world("plan.pgm", {"plan.pgm": pgm(picture)}, scale_m, seed)


def corners(world: World) -> set[tuple[float, float]]:
    return {(w.x1, w.y1) for w in world.walls}


@pytest.mark.slow
def test_a_rectangle_gives_its_walls_back() -> None:
    picture = room()
    picture[50:60, 70:100] = 0  # rows count from the top: 60 to 70 pixels above the lower edge
    world = from_picture(picture)
    assert corners(world) == {
        (0.25, 0.25), (7.75, 0.25), (7.75, 5.75), (0.25, 5.75),
        (3.5, 3.0), (5.0, 3.0), (5.0, 3.5), (3.5, 3.5),
    }  # fmt: skip
    assert len(world.walls) == 8
    assert sum(w.outer for w in world.walls) == 4


def test_origin_and_rotation() -> None:
    yaml = YAML.replace("[0, 0, 0]", f"[-3.5, 12.25, {math.pi / 6}]")
    world = import_world("m.yaml", {"m.yaml": yaml.encode(), "plan.pgm": pgm(room())})
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    wanted = [(-3.5 + c * x - s * y, 12.25 + s * x + c * y) for x in (0.25, 7.75) for y in (0.25, 5.75)]
    found = np.array(sorted(corners(world)))
    np.testing.assert_allclose(found, np.array(sorted(wanted)), atol=0.001)
    assert all(FreeSpace(world, 0.22).is_free(p.x, p.y) for p in world.starts)


@pytest.mark.parametrize("suffix", ["pgm", "png"])
def test_picture_formats_and_a_block_list(suffix: str) -> None:
    yaml = YAML.replace("[0, 0, 0]", "\n  - 0.0\n  - 0.0 # along x\n  - 0").replace("plan.pgm", f'"plan.{suffix}"')
    data = {"pgm": pgm, "png": png}[suffix](room())
    world = import_world("m.yaml", {"m.yaml": yaml.encode(), f"plan.{suffix}": data})
    assert corners(world) == corners(from_picture(room()))


def test_negate_and_modes() -> None:
    same = corners(from_picture(room()))
    negated = import_world(
        "m.yaml", {"m.yaml": YAML.replace("negate: 0", "negate: 1").encode(), "plan.pgm": pgm(255 - room())}
    )
    assert corners(negated) == same
    raw = np.where(room() > 0, 0, 100).astype(np.uint8)
    assert corners(import_world("m.yaml", {"m.yaml": (YAML + "mode: raw\n").encode(), "plan.pgm": pgm(raw)})) == same
    veiled = np.full((*room().shape, 4), 255, np.uint8)
    veiled[room() == 0, 3] = 0
    files = {"m.yaml": (YAML.replace("pgm", "png") + "mode: scale\n").encode(), "plan.png": png(veiled)}
    assert corners(import_world("m.yaml", files)) == same


def test_the_unknown_lies_outside() -> None:
    picture = room()
    picture[:, 100:] = 205  # map_server's grey
    world = from_picture(picture)
    assert world.bounds == (0.25, 0.25, 5.0, 5.75)


def test_the_robot_starts_on_the_largest_floor() -> None:
    picture = room()
    picture[:, 40:45] = 0  # a closet of 35 columns and a room of 110
    world = from_picture(picture)
    assert world.bounds[0] == 2.25
    assert all(start.x > 2.25 for start in world.starts)


def test_the_paper_around_a_plan_is_not_its_floor() -> None:
    picture = np.full((300, 400), 255, np.uint8)
    picture[100:220, 100:260] = room()
    world = from_picture(picture)
    assert world.bounds == (5.25, 4.25, 12.75, 9.75)
    open_field = np.full((300, 400), 255, np.uint8)
    open_field[100:110, 100:110] = 0
    assert from_picture(open_field).bounds == (0, 0, 20, 15)


def test_specks_and_slivers_go() -> None:
    picture = room()
    picture[30:32, 30:32] = 0
    picture[60:62, 155:] = 255  # a ray through a window
    assert len(from_picture(picture).walls) == 4
    picture[30:34, 30:34] = 0
    assert len(from_picture(picture).walls) == 8


def test_walls_of_pictures_are_textured_by_seed() -> None:
    first, again, other = from_picture(room()), from_picture(room()), from_picture(room(), seed=1)
    assert first == again != other
    assert corners(first) == corners(other)
    assert sum(len(w.panels) for w in first.walls) >= 0.6 * sum(w.length for w in first.walls)
    seeds = [p.seed for w in first.walls for p in w.panels]
    assert len(set(seeds)) == len(seeds)
    assert world_from_json(world_to_json(first), "copy.json") == first


@st.composite
def rectilinear(draw: st.DrawFn) -> NDArray[np.bool_]:
    """Floor on a coarse grid with fields 14 pixels wide, surrounded by wall."""
    fields = draw(st.lists(st.lists(st.booleans(), min_size=6, max_size=6), min_size=5, max_size=5))
    fields[2] = [True] * 6
    return np.pad(np.kron(np.array(fields), np.ones((14, 14), bool)), 3)


@settings(max_examples=40)
@given(rectilinear())
def test_rectilinear_plans_come_back(plan: NDArray[np.bool_]) -> None:
    rings = trace(plan)
    assert sum(map(ring_area, rings)) == plan.sum()
    assert [simplify(ring).tolist() for ring in rings] == [_from_its_lowest(ring) for ring in rings]
    world = from_picture(np.where(plan, 255, 0).astype(np.uint8)[::-1], 0.1)
    ends = {(round(x * 10), round(y * 10)) for x, y in corners(world)}
    assert ends <= {tuple(point) for ring in rings for point in ring.tolist()}
    floor = _inside(world, plan.shape)
    assert not (floor & ~plan).any()
    assert floor.sum() >= plan[31:45].sum() - 28 * 6  # the middle row of fields is always there


def _from_its_lowest(ring: NDArray[np.int32]) -> list[list[int]]:
    k = min(range(len(ring)), key=lambda i: (ring[i, 1], ring[i, 0]))
    return np.roll(ring, -k, axis=0).tolist()


def _inside(world: World, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """The world's floor as pixels of 0.1 m, by the number of walls to the right of each centre."""
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    crossings = np.zeros(shape, int)
    for x1, y1, _, y2 in world.segments() * 10:
        if abs(y1 - y2) > 1e-9:
            crossings += (y > min(y1, y2)) & (y < max(y1, y2)) & (x < x1)
    return crossings % 2 == 1


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(0.3, 0.7))
def test_simplified_walls_keep_the_tolerance(seed: int, share: float) -> None:
    """For any set of pixels, no wall is more than a pixel inside the floor, and no border more than 1.5 from its wall."""
    rng = np.random.default_rng(seed)
    mess = rng.random((18, 24)) < share
    for ring in trace(mess):
        short = simplify(ring)
        assert {tuple(p) for p in short.tolist()} <= {tuple(p) for p in ring.tolist()}
        assert _farthest(ring, short) <= 1.5 + 1e-9
        assert _farthest(short, ring) <= 1.5 + 1e-9


def _farthest(ring: NDArray[np.int32], other: NDArray[np.int32]) -> float:
    """The largest distance of points along the first ring from the second."""
    a, b = other.astype(float), np.roll(other, -1, axis=0).astype(float)
    starts, ends = ring.astype(float), np.roll(ring, -1, axis=0).astype(float)
    points = np.concatenate([starts + t * (ends - starts) for t in np.linspace(0, 1, 9)])
    along = b - a
    t = np.einsum("pkd,kd->pk", points[:, None] - a, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    nearest = a + np.clip(t, 0, 1)[:, :, None] * along
    return float(np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max())


# ---------------------------------------------------------------- vector maps


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


# ---------------------------------------------------------------- what is refused


def yaml_with(old: str, new: str) -> dict[str, bytes]:
    return {"m.yaml": YAML.replace(old, new).encode(), "plan.pgm": pgm(room())}


@pytest.mark.parametrize(
    ("files", "complaint"),
    [
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
        (yaml_with("negate", "negated"), r"line 4: unknown key 'negated'; expected one of: image"),
        (yaml_with("negate: 0", "negate: 0\nnegate: 1"), r"line 5: negate is there twice, first on line 4"),
        (yaml_with("negate: 0", "{a: !!python/object}"), r"line 4: got '{a.*expected `key: value`"),
        (yaml_with("plan.pgm", "../../etc/passwd"), r"line 1: image: got '../../etc/passwd'; must be the plain name"),
        (yaml_with("plan.pgm", "/etc/passwd"), r"image: got '/etc/passwd'; must be the plain name"),
        (yaml_with("plan.pgm", "..\\x.pgm"), r"must be the plain name"),
        (yaml_with("plan.pgm", ".."), r"must be the plain name"),
        (yaml_with("plan.pgm", "other.pgm"), r"'other.pgm' was not given with it"),
        ({"m.yaml": b"\xff\xfe"}, "m.yaml: not text: byte 0 is 0xff"),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n10 10\n255\nshort"}, "plan.pgm: the picture is broken"),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"hello"}, "plan.pgm: not a picture that can be read"),
        (
            {"m.yaml": YAML.encode(), "plan.pgm": b"P5\n90000 90000\n255\n"},
            "plan.pgm: hundreds of millions of pixels; at most 16",
        ),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n9000 9000\n255\n"}, "plan.pgm: 9000 x 9000 pixels; at most 16"),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n2 2\n65535\n" + bytes(8)}, "more than 8 bits"),
        ({"m.yaml": YAML.encode() + b"#" * 70_000}, "m.yaml: 70102 bytes; at most 65536"),
        (yaml_with("image: plan.pgm", "image: plan.pgm\nrobot"), "line 2: got 'robot'"),
    ],
)
def test_bad_map_server_files(files: dict[str, bytes], complaint: str) -> None:
    with pytest.raises(WorldError, match=complaint):
        import_world("m.yaml", files)


@pytest.mark.parametrize(
    ("picture", "scale_m", "complaint"),
    [
        (room(), None, "plan.pgm: a plain picture needs its scale"),
        (room(), 0.0, "got a scale of 0; must be from 0.001 to 1 m a pixel"),
        (room(), -1.0, "got a scale of -1; must be"),
        (room(), math.nan, "got a scale of nan; must be"),
        (room(), 1e9, "got a scale of 1e\\+09; must be"),
        (np.zeros((40, 40), np.uint8), 0.05, "no pixel is floor"),
        (room(), 0.002, r"no place where a robot of 0.22 m radius fits: the widest is 0.22 m"),
        (
            np.full((40, 40), 180, np.uint8),
            0.05,
            "no pixel is floor: .*column 0 of row 0, has grey 180; floor is light, .* below 0.196",
        ),
        (np.zeros((0, 0), np.uint8), 0.05, "plan.pgm: the picture is broken|not a picture"),
    ],
)
def test_bad_pictures(picture: NDArray[np.uint8], scale_m: float | None, complaint: str) -> None:
    with pytest.raises(WorldError, match=complaint):
        import_world("plan.pgm", {"plan.pgm": pgm(picture)}, scale_m)


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


def test_other_refusals(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match=r"plan.dwg: cannot be imported; expected .json"):
        import_world("plan.dwg", {"plan.dwg": b""})
    with pytest.raises(WorldError, match=r"x.json: is not among the files given: none"):
        import_world("x.json", {})
    with pytest.raises(WorldError, match="only plain pictures take one"):
        import_world("m.yaml", yaml_with("", ""), 0.05)
    path = tmp_path / "m.yaml"
    path.write_text(YAML, "utf-8")
    with pytest.raises(WorldError, match=r"plan.pgm: cannot be read"):
        import_file(path)
    with pytest.raises(WorldError, match="no world 'nowhere'"):
        open_world("nowhere")
    (tmp_path / "plan.pgm").write_bytes(pgm(room()))
    assert len(import_file(path).walls) == 4


def test_a_map_of_ten_thousand_walls_loads() -> None:
    """Pillars in rows: 2499 of them and the outline."""
    picture = np.full((1020, 1020), 255, np.uint8)
    for row in range(49):
        for column in range(51):
            picture[14 + 20 * row : 18 + 20 * row, 9 + 20 * column : 13 + 20 * column] = 0
    assert len(from_picture(picture, 0.1).walls) == 4 * 49 * 51 + 4

"""Pictures become worlds: their walls are where they were drawn, and what is no floor is left out."""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim2d import FreeSpace, WorldError, world_from_json, world_to_json
from sim2d.importers import import_file, import_world

from .plans import YAML, corners, from_picture, pgm, png, room


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


def test_a_map_of_ten_thousand_walls_loads() -> None:
    """Pillars in rows: 2499 of them and the outline."""
    picture = np.full((1020, 1020), 255, np.uint8)
    for row in range(49):
        for column in range(51):
            picture[14 + 20 * row : 18 + 20 * row, 9 + 20 * column : 13 + 20 * column] = 0
    assert len(from_picture(picture, 0.1).walls) == 4 * 49 * 51 + 4


_OTHERS_WRITE = {
    "unknown keys": (YAML + "georeference_type: none\nmap_id: [1, {a: 2}]\n", 2),
    "numbers in quotes": (YAML.replace("[0, 0, 0]", "['0.0', \"-0.0\", 0]").replace("0.05", "'5e-2'"), 0),
    "a list over lines": (YAML.replace("[0, 0, 0]", "[0,\n         0,\n 0.0]"), 0),
    "a directive": ("%YAML 1.2\n---\n" + YAML + "...\n", 0),
    "indented": ("".join(f"    {line}\n" for line in YAML.splitlines()), 0),
    "in braces": ("{" + YAML.strip().replace("\n", ", ") + "}", 0),
    "words for numbers": (YAML.replace("negate: 0", "negate: off"), 0),
    "no yaw": (YAML.replace("[0, 0, 0]", "[0, 0, -.nan]"), 1),
    "C's nan": (YAML.replace("[0, 0, 0]", "[0, 0, -nan]"), 1),
    "a path": (YAML.replace("plan.pgm", "maps/plan.pgm"), 1),
    "a path of another machine": (YAML.replace("plan.pgm", "/home/somebody/catkin_ws/plan.pgm"), 1),
    "a path of Windows": (YAML.replace("plan.pgm", "C:\\maps\\plan.pgm"), 1),
    "a path at home": (YAML.replace("plan.pgm", "~/plan.pgm"), 1),
}


@pytest.mark.parametrize("how", _OTHERS_WRITE)
def test_a_map_is_read_as_others_write_it_and_what_is_not_used_is_told(how: str, tmp_path: Path) -> None:
    """In memory, as both files come from the page, and on the disk."""
    (text, told), said = _OTHERS_WRITE[how], list[str]()
    same = corners(from_picture(room()))
    assert corners(import_world("m.yaml", {"m.yaml": text.encode(), "plan.pgm": pgm(room())}, tell=said.append)) == same
    assert len(said) == told
    (tmp_path / "m.yaml").write_text(text)
    (tmp_path / "plan.pgm").write_bytes(pgm(room()))
    assert corners(import_file(tmp_path / "m.yaml")) == same


def test_a_map_takes_no_picture_from_outside_its_folder(tmp_path: Path) -> None:
    (tmp_path / "in" / "maps").mkdir(parents=True)
    (tmp_path / "plan.pgm").write_bytes(pgm(room()))
    (tmp_path / "in" / "link.pgm").symlink_to(tmp_path / "plan.pgm")
    yaml = tmp_path / "in" / "m.yaml"
    for image in ("../plan.pgm", str(tmp_path / "plan.pgm"), "link.pgm"):
        yaml.write_text(YAML.replace("plan.pgm", image))
        with pytest.raises(WorldError, match=r"there is no file '\w+.pgm' in"):
            import_file(yaml)
    (tmp_path / "in" / "maps" / "plan.pgm").write_bytes(pgm(room()))
    yaml.write_text(YAML.replace("plan.pgm", "./maps/plan.pgm"))
    assert len(import_file(yaml).walls) == 4


@pytest.mark.parametrize("kind", ["PNG", "WEBP", "TIFF", "GIF", "palette"])
def test_what_is_transparent_is_white_paper(kind: str) -> None:
    """Dark lines and nothing else, as drawing programs export them: the colour of what is transparent does not count."""
    said, out = list[str](), BytesIO()
    drawn = np.zeros((*room().shape, 4), np.uint8)
    drawn[..., 3] = np.where(room() == 0, 255, 0)
    picture = Image.fromarray(drawn)
    if kind == "palette":
        picture.quantize(4).save(out, "PNG")
    else:
        picture.save(out, kind, **({"lossless": True} if kind == "WEBP" else {}))
    name = f"plan.{'png' if kind == 'palette' else kind.lower()}"
    world = import_world(name, {name: out.getvalue()}, 0.05, tell=said.append)
    assert corners(world) == corners(from_picture(room()))
    assert "transparent, which counts as white paper" in said[0]
    drawn[..., :3] = 255  # white on nothing: nobody could see it on paper
    with pytest.raises(WorldError, match="what is transparent counts as white paper, and nothing on it is dark"):
        import_world("plan.png", {"plan.png": png(drawn)}, 0.05)


def test_a_photograph_is_turned_as_the_camera_was_held() -> None:
    out, exif = BytesIO(), Image.Exif()
    exif[0x0112] = 6  # to be turned by a quarter, clockwise
    picture = room()
    picture[20:40, 20:30] = 0
    Image.fromarray(picture).save(out, "PNG", exif=exif)
    turned = from_picture(np.rot90(picture, -1))
    assert corners(import_world("plan.png", {"plan.png": out.getvalue()}, 0.05)) == corners(turned)

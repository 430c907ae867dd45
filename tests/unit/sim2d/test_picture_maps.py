"""Pictures become worlds: their walls are where they were drawn, and what is no floor is left out."""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from sim2d import FreeSpace, World, WorldError, world_from_json, world_to_json
from sim2d.importers import import_file, import_world

from .plans import YAML, corners, from_picture, pgm, png, room

SAME = corners(from_picture(room()))


def map_of(yaml: str, picture: bytes | None = None, name: str = "plan.pgm") -> World:
    return import_world("m.yaml", {"m.yaml": yaml.encode(), name: pgm(room()) if picture is None else picture})


def drawn(black: tuple[slice, slice], grey: int = 0) -> NDArray[np.uint8]:
    """The room with this part of it in another colour."""
    picture = room()
    picture[black] = grey
    return picture


def test_a_rectangle_gives_its_walls_back() -> None:
    world = from_picture(drawn(np.s_[50:60, 70:100]))  # rows count from the top: 60 to 70 pixels above the lower edge
    assert corners(world) == {
        (0.25, 0.25), (7.75, 0.25), (7.75, 5.75), (0.25, 5.75),
        (3.5, 3.0), (5.0, 3.0), (5.0, 3.5), (3.5, 3.5),
    }  # fmt: skip
    assert (len(world.walls), sum(w.outer for w in world.walls)) == (8, 4)


def test_origin_and_rotation() -> None:
    world = map_of(YAML.replace("[0, 0, 0]", f"[-3.5, 12.25, {math.pi / 6}]"))
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    wanted = [(-3.5 + c * x - s * y, 12.25 + s * x + c * y) for x in (0.25, 7.75) for y in (0.25, 5.75)]
    np.testing.assert_allclose(np.array(sorted(corners(world))), np.array(sorted(wanted)), atol=0.001)
    assert all(FreeSpace(world, 0.22).is_free(p.x, p.y) for p in world.starts)


def test_negate_and_modes() -> None:
    assert corners(map_of(YAML.replace("negate: 0", "negate: 1"), pgm(255 - room()))) == SAME
    raw = np.where(room() > 0, 0, 100).astype(np.uint8)
    assert corners(map_of(YAML + "mode: raw\n", pgm(raw))) == SAME
    veiled = np.full((*room().shape, 4), 255, np.uint8)
    veiled[room() == 0, 3] = 0
    assert corners(map_of(YAML.replace("pgm", "png") + "mode: scale\n", png(veiled), "plan.png")) == SAME


def test_the_unknown_lies_outside_and_the_robot_starts_on_the_largest_floor() -> None:
    assert from_picture(drawn(np.s_[:, 100:], 205)).bounds == (0.25, 0.25, 5.0, 5.75)  # map_server's grey
    world = from_picture(drawn(np.s_[:, 40:45]))  # a closet of 35 columns and a room of 110
    assert world.bounds[0] == 2.25
    assert all(start.x > 2.25 for start in world.starts)


def test_the_paper_around_a_plan_is_not_its_floor() -> None:
    picture = np.full((300, 400), 255, np.uint8)
    picture[100:220, 100:260] = room()
    assert from_picture(picture).bounds == (5.25, 4.25, 12.75, 9.75)
    open_field = np.full((300, 400), 255, np.uint8)
    open_field[100:110, 100:110] = 0
    assert from_picture(open_field).bounds == (0, 0, 20, 15)


def test_specks_and_slivers_go() -> None:
    picture = drawn(np.s_[30:32, 30:32])
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
    row, column = np.ogrid[:1020, :1020]
    picture = np.full((1020, 1020), 255, np.uint8)
    picture[((row - 14) % 20 < 4) & (row >= 14) & (row < 990) & ((column - 9) % 20 < 4) & (column >= 9)] = 0
    assert len(from_picture(picture, 0.1).walls) == 4 * 49 * 51 + 4


OTHERS_WRITE = {
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
    "a list in lines": (
        YAML.replace("[0, 0, 0]", "\n  - 0.0\n  - 0.0 # along x\n  - 0").replace("plan.pgm", '"plan.pgm"'),
        0,
    ),
}


def test_a_map_is_read_as_others_write_it_and_what_is_not_used_is_told(
    tmp_path: Path, subtests: pytest.Subtests
) -> None:
    """In memory, as both files come from the page, and on the disk."""
    (tmp_path / "plan.pgm").write_bytes(pgm(room()))
    for how, (text, told) in OTHERS_WRITE.items():
        with subtests.test(how):
            said = list[str]()
            files = {"m.yaml": text.encode(), "plan.pgm": pgm(room())}
            assert corners(import_world("m.yaml", files, tell=said.append)) == SAME
            assert len(said) == told
            (tmp_path / "m.yaml").write_text(text)
            assert corners(import_file(tmp_path / "m.yaml")) == SAME


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


def test_what_is_transparent_is_white_paper(subtests: pytest.Subtests) -> None:
    """Dark lines and nothing else, as drawing programs export them: the colour of what is transparent does not count."""
    lines = np.zeros((*room().shape, 4), np.uint8)
    lines[..., 3] = np.where(room() == 0, 255, 0)
    picture = Image.fromarray(lines)
    for kind in ("PNG", "WEBP", "TIFF", "GIF", "palette"):
        with subtests.test(kind):
            said, out = list[str](), BytesIO()
            if kind == "palette":
                picture.quantize(4).save(out, "PNG")
            else:
                picture.save(out, kind, **({"lossless": True} if kind == "WEBP" else {}))
            name = f"plan.{'png' if kind == 'palette' else kind.lower()}"
            assert corners(import_world(name, {name: out.getvalue()}, 0.05, tell=said.append)) == SAME
            assert "transparent, which counts as white paper" in said[0]
    lines[..., :3] = 255  # white on nothing: nobody could see it on paper
    with pytest.raises(WorldError, match="what is transparent counts as white paper, and nothing on it is dark"):
        import_world("plan.png", {"plan.png": png(lines)}, 0.05)


def test_a_photograph_is_turned_as_the_camera_was_held() -> None:
    out, exif = BytesIO(), Image.Exif()
    exif[0x0112] = 6  # to be turned by a quarter, clockwise
    picture = drawn(np.s_[20:40, 20:30])
    Image.fromarray(picture).save(out, "PNG", exif=exif)
    turned = from_picture(np.rot90(picture, -1))
    assert corners(import_world("plan.png", {"plan.png": out.getvalue()}, 0.05)) == corners(turned)

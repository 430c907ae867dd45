"""Files that cannot be imported are refused with file, line, value and what is right."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim2d import WorldError
from sim2d.importers import import_file, import_world, open_world

from .plans import YAML, pgm, room


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
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n10 10\n255\nshort"}, "plan.pgm: the picture is broken"),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"hello"}, "plan.pgm: not a picture that can be read"),
        (
            {"m.yaml": YAML.encode(), "plan.pgm": b"P5\n90000 90000\n255\n"},
            "plan.pgm: hundreds of millions of pixels; at most 16",
        ),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n9000 9000\n255\n"}, "plan.pgm: 9000 x 9000 pixels; at most 16"),
        ({"m.yaml": YAML.encode(), "plan.pgm": b"P5\n2 2\n65535\n" + bytes(8)}, "more than 8 bits"),
        ({"m.yaml": YAML.encode() + b"#" * 70_000}, "m.yaml: 70102 bytes; at most 65536"),
        (yaml_with("image: plan.pgm", "image: plan.pgm\nrobot"), "line 3: not YAML"),
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


def test_other_refusals(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match=r"plan.txt: cannot be imported; expected .json"):
        import_world("plan.txt", {"plan.txt": b""})
    with pytest.raises(WorldError, match=r"x.json: is not among the files given: none"):
        import_world("x.json", {})
    with pytest.raises(WorldError, match="only plain pictures take one"):
        import_world("m.yaml", yaml_with("", ""), 0.05)
    path = tmp_path / "m.yaml"
    path.write_text(YAML, "utf-8")
    with pytest.raises(WorldError, match=r"m.yaml: image: got 'plan.pgm', but there is no file 'plan.pgm'"):
        import_file(path)
    for name in ("plan.svg", "plan.pdf", "plan.DWG"):
        with pytest.raises(WorldError, match=r"a drawing in \w+ is not read; .* as PNG"):
            import_world(name, {name: b"<svg/>"}, 0.05)
    with pytest.raises(WorldError, match="no world 'nowhere'"):
        open_world("nowhere")
    (tmp_path / "plan.pgm").write_bytes(pgm(room()))
    assert len(import_file(path).walls) == 4

"""Recordings that were spoilt: files with other bytes, odd values, bombs, and names that lead elsewhere."""

from __future__ import annotations

import contextlib
import gzip
import math
import os
import re
import struct
import tempfile
import zlib
from functools import cache, partial
from pathlib import Path
from random import Random

import numpy as np
from mcap.writer import CompressionType

from app.headless.recorded import run_recording
from app.recordings.motion import OdometryErrors
from app.recordings.opening import Opening, check, open_recording
from app.recordings.playing import Player
from tests.fuzz.mutators import bytes_spoilt
from tests.recordings import FORMATS, mcap

VALUES = (b"nan", b"inf", b"-inf", b"1e400", b"-1e308", b"0", b"-1", b"1e18", b"99999999999999999999999", b"9" * 400,
          b"1e-320", b"", b"x", b"0x10", b"1_0", b"\xff\xfe", b"null", b"true", b'"1"', b"[]", b"{}", b"[" * 3000,
          b"../../../../etc/passwd", b"/etc/hostname", b"/dev/zero", b".", b"..", b"\x00", b"a" * 5000, b"pipe.png",
          b"loop.png", b"out.png", b"folder.png", b"1e9", b"1e5", b"2147483648", b"-9223372036854775808")  # fmt: skip
TEXTS = (".csv", ".txt", ".json", ".log", ".catalog", ".gz", ".yaml")
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
WORD = re.compile(rb"[^\s,;:\"\[\]{}]+")

Files = dict[str, bytes]  # name below the folder -> contents


@cache
def bases() -> dict[str, tuple[str, Files]]:
    """Of each format: the name to open, and its files."""
    formats = {name: (file, write) for name, (file, write, _) in FORMATS.items()}
    formats["mcap plain"] = "e.mcap", partial(mcap, packing=CompressionType.NONE, packed=True)
    found: dict[str, tuple[str, Files]] = {}
    for name, (file, write) in formats.items():
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder) / file)
            files = {str(p.relative_to(folder)): p.read_bytes() for p in Path(folder).rglob("*") if p.is_file()}
            found[name] = file, files
    return found


def recording(rng: Random) -> str:
    """Spoil a recording, read all of it, and play it. Returns what became of it."""
    name = rng.choice(list(bases()))
    file, files = bases()[name]
    files = dict(files)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        at = _chosen(files, rng)
        files[at] = _spoilt(at, files[at], rng)
    with tempfile.TemporaryDirectory() as folder:
        _lay_out(Path(folder), file, files, rng)
        return _used(Path(folder) / file, rng)


def _chosen(files: Files, rng: Random) -> str:
    """The file that tells the most, more often than one of its pictures."""
    others = [name for name in files if not name.endswith(".png")]
    return rng.choice(others if others and rng.random() < 0.7 else list(files))


def _spoilt(name: str, data: bytes, rng: Random) -> bytes:
    if name.endswith(".gz") and len(data) < 10_000 and rng.random() < 0.8:
        if rng.random() < 0.05:
            return gzip.compress(rng.choice((b"\0", b"FLASER 5 1\n", b"[")) * 5_000_000, 1)
        with contextlib.suppress(OSError, EOFError, zlib.error):  # spoilt before
            return gzip.compress(_text_spoilt(gzip.decompress(data), rng), 1)
    if name.endswith(TEXTS) and not name.endswith(".gz") and rng.random() < 0.8:
        return _text_spoilt(data, rng)
    if name.endswith(".png") and rng.random() < 0.4:
        return _picture(rng)
    if rng.random() < 0.1:
        return rng.choice((b"", b"\0" * 5000, rng.randbytes(3000), data * 3, data[: len(data) // 2]))
    return _claiming(data, rng) if rng.random() < 0.25 else bytes_spoilt(data, rng, rng.choice(_others()))


@cache
def _others() -> list[bytes]:
    return [data for _, files in bases().values() for data in files.values()]


def _text_spoilt(data: bytes, rng: Random) -> bytes:
    """Some numbers and words exchanged, lines lost, doubled, exchanged."""
    for _ in range(rng.choice((1, 1, 3, 10))):
        data, kind = data[:500_000], rng.random()
        found = list((NUMBER if rng.random() < 0.6 else WORD).finditer(data))
        if kind < 0.6 and found:
            where = rng.choice(found)
            data = data[: where.start()] + rng.choice(VALUES) + data[where.end() :]
        elif kind < 0.85:
            lines = data.split(b"\n")
            at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[at : at + 1] = rng.choice(([], [lines[at]] * 2, [lines[other]], [lines[at] * 50], [lines[at][:5]]))
            data = b"\n".join(lines)
        else:
            data = bytes_spoilt(data, rng)
    return data


def _claiming(data: bytes, rng: Random) -> bytes:
    """A length somewhere that is far too large."""
    out = bytearray(data)
    kind, value = rng.choice(
        (("<I", 2**32 - 1), ("<Q", 2**63), ("<I", 10**9), (">I", 2**31 - 1), ("<Q", 2**40), ("<I", 0))
    )
    if len(out) > 8:
        struct.pack_into(kind, out, rng.randrange(len(out) - 8), value)
    return bytes(out)


def _picture(rng: Random) -> bytes:
    """A PNG that claims to be huge, or is."""
    width, height = rng.choice(((60_000, 60_000), (20_000, 20_000), (0, 5), (12_001, 1), (4000, 4000), (2**31 - 1, 1)))

    def part(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    body = zlib.compress(bytes(min(width * height * 3 + height, 49_000_000)), 1) if rng.random() < 0.1 else b"x"
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + part(b"IDAT", body) + part(b"IEND", b"")


def _lay_out(folder: Path, file: str, files: Files, rng: Random) -> None:
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    home = folder / file if (folder / file).is_dir() else folder
    if rng.random() < 0.3:
        os.mkfifo(home / "pipe.png")
        (home / "loop.png").symlink_to("loop.png")
        (home / "out.png").symlink_to("/etc/passwd")
        (home / "folder.png").mkdir()
    if rng.random() < 0.1 and len(files) > 1:
        (folder / rng.choice(list(files))).unlink()


def _used(path: Path, rng: Random) -> str:
    made = OdometryErrors(0.1, 0.02, 0.005) if rng.random() < 0.05 else None
    found = open_recording(path, Opening(made=made, seed=1))
    last = -1.0
    for moment in found.moments():
        values = (moment.speed, moment.yaw_rate, moment.throttle, *(moment.truth or ()))
        assert last < moment.time_s < 1e9, moment.time_s
        assert 0 < moment.dt < 1e9, moment.dt
        assert all(value is None or math.isfinite(value) for value in values), values
        assert moment.image is None or (moment.image.dtype == np.uint8 and moment.image.ndim == 3)
        assert moment.ranges_m is None or not np.isnan(moment.ranges_m).any()
        last = moment.time_s
    checked = check(found)
    for sentence in (*checked.about.problems, *checked.lines):
        assert len(sentence) < 1000, sentence
        assert sentence.isprintable(), sentence
    report, trace, brain = run_recording(Player(found, 1))
    assert report["frames"] == checked.moments == len(list(trace.lines(brain.experience_map))) - 1
    return "taken"


def warm() -> None:
    """Compile whatever a case needs."""
    for file, files in bases().values():
        with tempfile.TemporaryDirectory() as folder:
            _lay_out(Path(folder), file, files, Random(1))
            _used(Path(folder) / file, Random(1))

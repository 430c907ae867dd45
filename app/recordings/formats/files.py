"""Files as they lie on a disk. Text line by line, packed or not, in any encoding that programs write, with a limit for each
line and for all. Archives unpacked into a folder of their own, within limits, and nowhere else.

Refused: names that lead out of the folder, more files or bytes than a recording has, and what unpacks to a hundred
times its size. Links and devices are left out and told of. test_folders.py. Zstandard and LZ4 are unpacked in memory.
"""

from __future__ import annotations

import codecs
import gzip
import io
import lzma
import os
import shutil
import stat
import tarfile
import tempfile
import zipfile
import zlib
from collections.abc import Generator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Any, cast

import lz4.frame  # pyright: ignore[reportMissingTypeStubs]
import zstandard

from disk.words import plain

MOST_LINE, MOST_TEXT_BYTES = 1_000_000, 4_000_000_000
UNPACKED = 40  # times its size; more is a bomb
_LOOK = 4096  # bytes, to find the encoding
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"), (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip


def open_whole(path: Path) -> IO[bytes]:
    """A regular file, unpacked if its name ends with .gz. ValueError: it is none, or may not be read."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        file = os.fdopen(handle, "rb")
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            file.close()
            raise ValueError(f"{path}: not a file")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror or error}") from None
    if path.suffix.lower() != ".gz":
        return file
    unpacked = gzip.GzipFile(fileobj=file)
    unpacked.myfileobj = cast(Any, file)  # so that it is closed with it
    return cast(IO[bytes], unpacked)


def encoding_of(start: bytes) -> str:
    """Of a text that begins so: by its mark, by its zeros, UTF-8 where it is that, and else what Windows writes in the west."""
    for mark, name in _MARKS:
        if start.startswith(mark):
            return name
    if start[1:200:2].count(0) * 4 > len(start[1:200]):  # every other byte of Latin text
        return "utf-16-le"
    if start[0:200:2].count(0) * 4 > len(start[:200]):
        return "utf-16-be"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(start)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def lines_of(path: Path) -> Generator[tuple[int, str], None, None]:
    """Number (from 1) and text of each line, without its end: CR, LF or both. ValueError: the file is broken or far too large."""
    total, number = 0, 0
    packed = path.suffix.lower() == ".gz"
    try:
        with open_whole(path) as file:
            start = file.read(_LOOK)
        file = open_whole(path)
    except (OSError, EOFError, zlib.error) as error:
        raise ValueError(f"{path.name}: broken after line 0: {error}") from None
    with io.TextIOWrapper(file, encoding_of(start), errors="replace") as text:
        most = UNPACKED * path.stat().st_size + MOST_LINE if packed else MOST_TEXT_BYTES
        while True:
            try:
                line = text.readline(MOST_LINE + 1)
            except (OSError, EOFError, zlib.error) as error:
                raise ValueError(f"{path.name}: broken after line {number}: {error}") from None
            if not line:
                return
            number, total = number + 1, total + len(line)
            if packed and total > most:
                raise ValueError(f"{path.name}: unpacks to more than {UNPACKED} times its size; no log of a robot does")
            if len(line) > MOST_LINE or total > most:
                raise ValueError(
                    f"{path.name}: line {number}: too long; at most {MOST_LINE} characters, {MOST_TEXT_BYTES} in all"
                )
            yield number, line.rstrip("\r\n")


MOST_BYTES, MOST_FILES, MOST_RATIO = 16_000_000_000, 500_000, 100
SPARE_BYTES = 500_000_000  # of the disk are left free
_SMALL = 10_000_000  # bytes that any archive may unpack to
_PIECE = 1 << 20
ZSTD = b"\x28\xb5\x2f\xfd"  # with which each frame begins
_OTHERS = ((b"7z\xbc\xaf'\x1c", "7z"), (b"Rar!", "RAR"), (ZSTD, "Zstandard"))
_ZIP = (b"PK\x03\x04", b"PK\x05\x06")
_PACKED = (b"\x1f\x8b", b"BZh", b"\xfd7zXZ\0")
# Broken files; RuntimeError: one with a password, or packed in a way that the library does not know.
_BROKEN = (
    tarfile.TarError, zipfile.BadZipFile, OSError, EOFError, zlib.error, lzma.LZMAError, LookupError, RuntimeError,
)  # fmt: skip


def is_archive(path: Path) -> bool:
    """Whether this reads it. ValueError: it is an archive of a kind that is not read."""
    with path.open("rb") as file:
        start = file.read(512)
    for magic, kind in _OTHERS:
        if start.startswith(magic):
            raise ValueError(f"{path.name}: {kind} archives are not read; pack it as .zip or .tar.gz, or unpack it")
    if start.startswith(_ZIP) or start[257:262] == b"ustar":
        return True
    return start.startswith(_PACKED) and _is_tar(path)


def _is_tar(path: Path) -> bool:
    try:
        with tarfile.open(path, "r|*") as tar:
            return tar.next() is not None
    except (tarfile.TarError, OSError, EOFError, zlib.error, lzma.LZMAError):
        return False


def unpack(path: Path) -> tuple[Path, tuple[str, ...]]:
    """The folder that it was unpacked into, which is the caller's to delete, and a sentence for each member that was
    left out. ValueError: it is broken, or more than a recording is."""
    folder = Path(tempfile.mkdtemp(prefix="ratslam-unpacked-"))
    try:
        return folder, _unpack(path, folder)
    except BaseException as error:
        shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, _BROKEN):
            why = getattr(error, "strerror", None) or plain(str(error)) or "it is cut off"
            raise ValueError(f"{path.name}: cannot be unpacked: {why}") from None
        raise


def _unpack(path: Path, folder: Path) -> tuple[str, ...]:
    most = min(MOST_BYTES, max(_SMALL, MOST_RATIO * path.stat().st_size))
    room = shutil.disk_usage(folder).free - SPARE_BYTES
    total, unused = 0, list[str]()
    with path.open("rb") as file:
        zipped = file.read(4) in _ZIP
    with closing(_zip(path) if zipped else _tar(path)) as members:
        for number, member in enumerate(members):
            if number >= MOST_FILES:
                raise ValueError(f"{path.name}: more than {MOST_FILES} files in it")
            place = _place(path, folder, member.name)
            if member.file is None:
                unused.append(f"{plain(member.name, 80)}: a link or a device, which is not unpacked")
                continue
            place.parent.mkdir(parents=True, exist_ok=True)
            with member.file, place.open("wb") as out:
                while piece := member.file.read(_PIECE):
                    total += len(piece)
                    if total > most:
                        raise ValueError(
                            f"{path.name}: unpacks to more than {most} bytes, {MOST_RATIO} times its size at most"
                        )
                    if total > room:
                        raise ValueError(f"{path.name}: there is no room for it in {folder.parent}")
                    out.write(piece)
    return tuple(unused)


def _place(path: Path, folder: Path, name: str) -> Path:
    parts = PurePosixPath(name.replace("\\", "/")).parts
    if not parts or ".." in parts or parts[0] == "/" or ":" in parts[0] or "\0" in name or len(name) > 1000:
        raise ValueError(f"{path.name}: {plain(name, 80)!r} in it would lead out of its folder; nothing was unpacked")
    return folder.joinpath(*parts)


@dataclass(frozen=True, slots=True)
class _Member:
    name: str
    file: IO[bytes] | None  # None: no regular file


def _zip(path: Path) -> Generator[_Member, None, None]:
    with zipfile.ZipFile(path) as packed:
        infos = packed.infolist()
        if len(infos) > MOST_FILES:
            raise ValueError(f"{path.name}: more than {MOST_FILES} files in it")
        for info in infos:
            if info.is_dir():
                continue
            mode = info.external_attr >> 16
            regular = mode & 0o170000 in (0, 0o100000)
            yield _Member(info.filename, packed.open(info) if regular else None)


def _tar(path: Path) -> Generator[_Member, None, None]:
    with tarfile.open(path, "r|*") as packed:
        for info in packed:
            if not info.isdir():
                yield _Member(info.name, packed.extractfile(info) if info.isreg() else None)


def zstd_unpacked(data: bytes, most: int) -> bytes:
    """ValueError: it is broken, or unpacks to more than `most` bytes.

    Fed piece by piece, since it has no limit of its own: a piece of 1 kB unpacks to some 16 MB at most.
    """
    unpacker: Any = zstandard.ZstdDecompressor().decompressobj()
    out = bytearray()
    try:
        for at in range(0, len(data), 1024):
            out += unpacker.decompress(data[at : at + 1024])
            if len(out) > most:
                raise ValueError(f"more than the {most} bytes that it says")
            if unpacker.eof:
                break
    except zstandard.ZstdError as error:
        raise ValueError(f"cannot be unpacked: {error}") from None
    return bytes(out)


def lz4_unpacked(data: bytes, most: int) -> bytes:
    """ValueError: it is broken, or unpacks to more than `most` bytes."""
    unpacker: Any = lz4.frame.LZ4FrameDecompressor()
    out: bytes = unpacker.decompress(data, max_length=most + 1)
    if len(out) > most:
        raise ValueError(f"more than the {most} bytes that it says")
    return out

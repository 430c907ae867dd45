"""The file around a snapshot (.npz: arrays, and JSON as bytes). Limits are checked before anything is unpacked.

Half a megabyte of zeros can unpack to half a gigabyte, and a header can claim anything.
"""

from __future__ import annotations

import json
import math
import os
import re
import struct
import zipfile
import zlib
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

MOST_BYTES = 512 << 20  # of all arrays together, as they lie in memory
MOST_JSON_BYTES = 16 << 20  # no part of the JSON grows with the map (state_codec.py)
FAST = 3  # zlib's level: half the time of the usual one, 3 % larger
MOST_ARRAYS = 500
MOST_DIRECTORY_BYTES = 128 * MOST_ARRAYS
_HEADER = re.compile(
    rb"\{'descr': '[<|][biuf]([1248])', 'fortran_order': False, 'shape': \(((?:\d{1,12}, )*(?:\d{1,12},?)?)\), \}\s*"
)
_LONGEST_HEADER = 256
_END = b"PK\x05\x06"  # a zip file ends with this, counts, and the size of its directory
# The errors that reading a broken file can raise.
BROKEN = (
    ValueError, LookupError, TypeError, AttributeError, ImportError, EOFError, ArithmeticError, RuntimeError, MemoryError,
    struct.error, zlib.error, zipfile.BadZipFile, zipfile.LargeZipFile,
)  # fmt: skip


def pack(file: IO[bytes], tree: dict[str, Any], arrays: list[NDArray[Any]], note: str = "") -> None:
    """Write what `unpack` reads. note: stored in the file's directory.

    ValueError, before a byte is written, when it would be too large to be read again.
    """
    text = np.frombuffer(json.dumps(tree).encode(), np.uint8)
    named = {"json": text} | {f"a{k}": array for k, array in enumerate(arrays)}
    for what, size, most in (("JSON", text.nbytes, MOST_JSON_BYTES), ("arrays", room_of([text, *arrays]), MOST_BYTES)):
        if size > most:
            raise ValueError(
                f"too large for a file: {size >> 20} MiB of {what}, at most {most >> 20} can be read again"
            )
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=FAST) as archive:
        for name, array in named.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                npy.write_array(entry, array, allow_pickle=False)
        archive.getinfo("json.npy").comment = note.encode()


def room_of(arrays: list[NDArray[Any]]) -> int:
    """How many of MOST_BYTES the arrays take at most."""
    return sum(array.nbytes + _LONGEST_HEADER for array in arrays)


def unpack(file: IO[bytes]) -> tuple[dict[str, Any], list[NDArray[Any]]]:
    """The JSON and the arrays in the file. Raises one of BROKEN when they cannot be read."""
    _require_directory(file)
    with zipfile.ZipFile(file) as archive:
        entries = {entry.filename.removesuffix(".npy"): entry for entry in archive.infolist()}
        names = ["json", *(f"a{k}" for k in range(len(entries) - 1))]
        if sorted(entries) != sorted(names) or len(entries) != len(archive.infolist()):
            raise ValueError(f"it must hold json and a0, a1 and so on, got {', '.join(list(entries)[:6]) or 'nothing'}")
        if entries["json"].file_size > MOST_JSON_BYTES:
            raise ValueError(
                f"its JSON has {entries['json'].file_size >> 20} MiB, at most {MOST_JSON_BYTES >> 20} are allowed"
            )
        size = sum(entry.file_size for entry in entries.values())
        if size > MOST_BYTES:
            raise ValueError(f"too large: {size >> 20} MiB unpacked, at most {MOST_BYTES >> 20} are allowed")
        for name in names:
            _require_entry(archive, entries[name], name)
        text, *arrays = (_array(archive, entries[name]) for name in names)
    tree: dict[str, Any] | list[Any] | str | float | None = json.loads(text.tobytes())
    if not isinstance(tree, dict):
        raise ValueError(f"its JSON must be an object, got a {type(tree).__name__}")
    return tree, arrays


def _require_directory(file: IO[bytes]) -> None:
    """Check the size of a zip file's directory first, since the directory is read as a whole."""
    size = file.seek(0, os.SEEK_END)
    if size == 0:
        raise ValueError("the file is empty")
    file.seek(-min(size, 42), os.SEEK_END)
    tail = file.read()
    file.seek(0)
    if tail[-22:-18] != _END or tail[:4] == b"PK\x06\x07":
        raise ValueError("the file is not a zip file; it has to be one that was saved")
    directory = struct.unpack("<I", tail[-10:-6])[0]
    if directory > MOST_DIRECTORY_BYTES:
        raise ValueError(f"its directory has {directory} bytes; at most {MOST_DIRECTORY_BYTES} are allowed")


def _require_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str) -> None:
    """Check one array's entry: its header says type and shape and nothing else, and its size is what the header claims."""
    if entry.flag_bits & 1:
        raise ValueError(f"{name} is encrypted; a brain is not")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{name} is packed in an unusual way; it has to be one that was saved")
    with archive.open(entry) as data:
        header = npy.read_magic(data) == (1, 0) and _HEADER.fullmatch(data.read(*struct.unpack("<H", data.read(2))))
        if not header:
            raise ValueError(f"{name} is not an array of plain numbers as it is saved, row after row")
        shape = [int(n) for n in header[2].decode().rstrip(",").split(", ") if n]
        claimed, there = math.prod(shape) * int(header[1]), entry.file_size - data.tell()
        if claimed != there:
            raise ValueError(f"{name} claims to be of shape {str(shape)[:60]} but has {there} bytes")


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(entry) as data:
        return npy.read_array(data, allow_pickle=False)

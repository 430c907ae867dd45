"""The file around a brain: its claims are checked before anything is unpacked, and every odd zip file gets a sentence."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from typing import Any

import numpy as np
import pytest

from disk.archive import BROKEN, unpack
from ratslam_core.brain_file import read_brain


def archive(method: int = zipfile.ZIP_DEFLATED, **parts: bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as file:
        for name, content in {"json": saved(np.frombuffer(b"{}", np.uint8)), **parts}.items():
            file.writestr(f"{name}.npy", content)
    return out.getvalue()


def saved(array: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, array)
    return out.getvalue()


def tree(text: bytes) -> bytes:
    return archive(json=saved(np.frombuffer(text, np.uint8)))


def claiming(words: bytes) -> bytes:
    """An array whose header says something else."""
    header = words.ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + bytes(64)


def flagged(data: bytes, field: int, value: int) -> bytes:
    """The file with another number in both headers of the first entry, its own and the directory's."""
    out = bytearray(data)
    struct.pack_into("<H", out, field, value)
    struct.pack_into("<H", out, data.find(b"PK\x01\x02") + field + 2, value)
    return bytes(out)


def test_what_is_odd_is_said_in_a_sentence(subtests: pytest.Subtests) -> None:
    damaged = bytearray(archive(a0=saved(np.arange(5000))))
    damaged[len(damaged) // 2 : len(damaged) // 2 + 40] = bytes(40)
    with pytest.raises(BROKEN):
        unpack(io.BytesIO(bytes(damaged)))
    for data, words in (
        (b"", "the file is empty"),
        (b"a picture of a cat", "not a zip file"),
        (archive() + b"more", "not a zip file"),
        (archive()[:-10] + b"\xff\xff\xff\x7f" + archive()[-6:], "its directory has 2147483647 bytes"),
        (flagged(archive(), 6, 1), "json is encrypted"),
        (flagged(archive(), 8, 12), "json is packed in an unusual way"),
        (archive(zipfile.ZIP_LZMA), "json is packed in an unusual way"),
        (archive(b0=b""), "it must hold json and a0, a1 and so on, got json, b0"),
        (archive(a0=b"no array"), "magic string is not correct"),
        (archive(a0=saved(np.array(["text"]))), "a0 is not an array of plain numbers"),
        (archive(a0=saved(np.array([{}], object))), "a0 is not an array of plain numbers"),
        (archive(a0=saved(np.zeros((3, 2), order="F"))), "a0 is not an array of plain numbers"),
        (archive(a0=claiming(b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999,), }")), "a0 claims to be of"),
        (archive(a0=claiming(b"{'descr': '<f8', 'fortran_order': False, 'shape': " + b"(" * 50)), "a0 is not an array"),
        (archive(a0=saved(np.zeros(9))[:-8]), "a0 claims to be of shape"),
        (bytes(damaged), ""),
        (tree(b"[]"), "its JSON must be an object, got a list"),
        (tree(b"[" * 100_000), "it is nested too deeply"),
        (tree(b'{"digest": ' + b"9" * 5000 + b"}"), "Exceeds the limit"),
        (tree(b"\xff"), "codec can't decode"),
        (tree(json.dumps({"digest": "", "brain": {"dict": 3}}).encode()), "its digest does not fit"),
    ):  # fmt: skip
        with subtests.test(words):
            with pytest.raises(ValueError, match=r"^no brain that can be taken back: ") as said:
                read_brain(io.BytesIO(data))
            assert words in str(said.value)


def test_a_bomb_is_not_unpacked() -> None:
    """Its entries together claim more than is allowed, and none of them is opened."""
    data = archive(**{f"a{k}": b"not even an array" for k in range(3)})
    at = data.find(b"PK\x01\x02")
    while at >= 0:
        data = data[: at + 24] + struct.pack("<I", 300 << 20) + data[at + 28 :]
        at = data.find(b"PK\x01\x02", at + 4)
    with pytest.raises(ValueError, match="at most"):
        unpack(io.BytesIO(data))

"""Unpacks zstd and lz4, and never more than was said."""

from __future__ import annotations

from typing import Any

import lz4.frame  # pyright: ignore[reportMissingTypeStubs]
import zstandard

ZSTD = b"\x28\xb5\x2f\xfd"  # with which each frame begins


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

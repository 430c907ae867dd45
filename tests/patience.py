"""How long a test waits for something that must happen: longer than any machine needs. Only a fault waits to the end."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

PATIENCE_S = 180.0
Found = TypeVar("Found")


def until(look: Callable[[], Found], what: object = "it") -> Found:
    """The first value seen that counts as true."""
    end = time.monotonic() + PATIENCE_S
    while not (found := look()):
        assert time.monotonic() < end, f"not within {PATIENCE_S:g} s: {what}"
        time.sleep(0.01)
    return found

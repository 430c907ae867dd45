"""A disk that is full after a number of bytes, simulated without root by the largest file that this process may write."""

from __future__ import annotations

import contextlib
import resource
from collections.abc import Iterator


@contextlib.contextmanager
def full_after(count: int) -> Iterator[None]:
    """Files of at most `count` bytes. Python ignores SIGXFSZ, so a longer write is an OSError. Print nothing meanwhile."""
    before, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (before, most))

"""A disk that is full after so many bytes, without being root: the largest file that this process may write."""

from __future__ import annotations

import contextlib
import resource
from collections.abc import Iterator


@contextlib.contextmanager
def full_after(count: int) -> Iterator[None]:
    """Python ignores SIGXFSZ, so that a write beyond it is an OSError. Print nothing meanwhile."""
    before, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (count, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (before, most))

"""Arrays that nobody can write to, as those of real snapshots are."""

from __future__ import annotations

from numpy.typing import NDArray


def frozen(array: NDArray) -> NDArray:  # type: ignore[type-arg]
    array.setflags(write=False)
    return array

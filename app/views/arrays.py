"""Arrays that a snapshot shares with other threads are read-only."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Kind = TypeVar("Kind", bound=np.generic)


def frozen(array: NDArray[Kind]) -> NDArray[Kind]:
    """The same array, read-only from now on."""
    array.setflags(write=False)
    return array

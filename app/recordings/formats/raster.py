"""Scans whose beams differ from one to the next, laid onto the same beams by their angles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from app.recordings.formats.sensed import Beams

LEAST = 0.5  # a scan that looks at less of the field is no scan of it


def typical(beams: Sequence[Beams]) -> Beams:
    """[ours] The middle one, ordered by number, first and last angle: the usual one where there is one, never the odd one."""
    return sorted(beams, key=lambda b: (len(b.angles_rad), b.angles_rad[:1], b.angles_rad[-1:], b.limit_m or 0))[
        len(beams) // 2
    ]


def laid_on(raster: Beams, beams: Beams, ranges_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each of the raster's beams gets the range of the nearest beam, and inf where there is none.

    ranges_m: of `beams`. The result has as many as the raster. ValueError: it looks somewhere else.
    """
    if beams.angles_rad == raster.angles_rad:
        return ranges_m
    own, wanted = np.mod(beams.angles_rad, math.tau), np.mod(raster.angles_rad, math.tau)
    order = np.argsort(own, kind="stable")
    round_ = np.concatenate(([own[order[-1]] - math.tau], own[order], [own[order[0]] + math.tau]))
    number = np.concatenate(([order[-1]], order, [order[0]]))
    after = np.clip(np.searchsorted(round_, wanted), 1, len(round_) - 1)
    nearest = np.where(wanted - round_[after - 1] <= round_[after] - wanted, after - 1, after)
    seen = np.abs(round_[nearest] - wanted) <= 0.501 * max(_step(beams), _step(raster))
    if seen.mean() < LEAST:
        raise ValueError(f"its {len(own)} ranges cover less than half of where the other scans look")
    return np.where(seen, ranges_m[number[nearest]], np.inf)


def _step(beams: Beams) -> float:
    """The usual angle between neighbours (rad)."""
    return float(np.median(np.abs(np.diff(beams.angles_rad)))) if len(beams.angles_rad) > 1 else 0.0

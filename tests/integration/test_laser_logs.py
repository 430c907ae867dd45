"""Logs of a laser give a true map, also as other robots would have written them."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.recordings.opening import open_recording
from benchmarks.laser_variants import OF_A_LOG, Logged, log_of
from benchmarks.recordings import of_known, play

INTEL = Path(__file__).parents[3] / "shared" / "data" / "logs" / "intel"


@pytest.mark.long
@pytest.mark.parametrize("name", ["as it is", "every second scan"])
def test_a_log_that_nobody_tuned_on(name: str) -> None:
    if not INTEL.exists():
        pytest.skip(f"{INTEL} is not there")
    log = OF_A_LOG[name](log_of(open_recording(INTEL / "intel_gfs.gz")))
    played = play(Logged(log, name))
    of_map, of_scans = (of_known(log, path, INTEL / "intel.relations") for path in (played.path, played.odometry))
    assert of_map <= 0.5
    assert of_map < of_scans

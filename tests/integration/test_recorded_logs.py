"""Recordings of real robots give true maps: logs of a laser, also as other robots would have written them, and a camera."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.recordings.opening import open_recording
from benchmarks.laser_variants import OF_A_LOG, Logged, log_of
from benchmarks.recordings import laps, of_known, play, together

DATA = Path(__file__).parents[3] / "shared" / "data"
INTEL, CAR = DATA / "logs" / "intel", DATA / "recordings" / "office-car"


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


def test_a_car_with_a_camera_that_nobody_tuned_on() -> None:
    """Laps of an office, judged by hand. It makes experiences also while it believes itself elsewhere."""
    if not CAR.exists():
        pytest.skip(f"{CAR} is not there")
    played, pairs = play(open_recording(CAR)), CAR / "laps.csv"
    recall, precision = laps(played, pairs)
    assert recall > 0.6
    assert precision > 0.95
    assert together(played, played.path, pairs)[0] < together(played, played.odometry, pairs)[0]

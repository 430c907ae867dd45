"""The benchmark of kidnaps that are missed asks the detector that the robot has."""

from __future__ import annotations

import pytest

from app.config import Config
from app.session import Session
from benchmarks.alarms import APART_M, APART_RAD, drive, kidnaps, noticed
from sim2d import load_world


@pytest.mark.slow
def test_few_kidnaps_are_missed_and_driving_is_none() -> None:
    session = Session(load_world("office"), 4, Config())
    moments = list(drive(session, 3.0))
    assert session.brain.experience_map.submaps.begun == 0
    pairs = list(kidnaps(moments, 4))
    assert len(pairs) > 1000
    for before, after in pairs[:100]:
        apart_m = ((before.place[0] - after.place[0]) ** 2 + (before.place[1] - after.place[1]) ** 2) ** 0.5
        assert apart_m > APART_M or abs(before.place[2] - after.place[2]) > APART_RAD
    missed = [not noticed(session, *pair) for pair in pairs]
    assert sum(missed) <= 0.05 * len(missed)
    session.set_parameter("kidnap.range_surprise", 0.0)  # what sonars add
    assert sum(not noticed(session, *pair) for pair in pairs) > 2 * sum(missed)

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from sim2d import OfficeParams, SimParams


def test_defaults_are_the_ones_asked_for() -> None:
    p = SimParams()
    assert (p.physics_rate_hz, p.sensor_rate_hz, p.substeps, p.tick_s) == (240, 10, 24, 0.1)
    assert (p.odometry_noise, p.odometry_scale_error) == (0.05, 0.02)
    assert [math.degrees(p.gyro_bias), math.degrees(p.camera_fov_rad)] == pytest.approx([0.2, 50])


def test_what_does_not_go_together_is_refused() -> None:
    rows: list[tuple[Any, dict[str, float], str]] = [
        (SimParams, {"image_width": 64.5}, r"image_width must be a whole number, got 64\.5"),
        (SimParams, {"sensor_rate_hz": 7}, r"physics_rate_hz must be a multiple of sensor_rate_hz \(7\), got 240"),
        (OfficeParams, {"patience_least_s": 9.0}, r"patience_least_s must be at most patience_most_s \(8\), got 9"),
        (OfficeParams, {"patience_most_s": 2.5}, r"patience_least_s must be at most patience_most_s \(2\.5\), got 3"),
    ]
    for kind, values, reason in rows:
        with pytest.raises(ValueError, match=reason):
            replace(kind(), **values)
    assert OfficeParams(patience_least_s=8.0).patience_most_s == 8.0

from __future__ import annotations

import math
from dataclasses import fields, replace

import pytest

from sim2d import OfficeParams, SimParams


def test_defaults_are_the_ones_asked_for() -> None:
    p = SimParams()
    assert (p.physics_rate_hz, p.sensor_rate_hz, p.substeps, p.tick_s) == (240, 10, 24, 0.1)
    assert (p.odometry_noise, p.odometry_scale_error) == (0.05, 0.02)
    assert math.degrees(p.gyro_bias) == pytest.approx(0.2)
    assert math.degrees(p.camera_fov_rad) == pytest.approx(50)


ITEMS = [(kind, item) for kind in (SimParams, OfficeParams) for item in fields(kind)]


def test_every_parameter_is_declared_in_full_and_checked(subtests: pytest.Subtests) -> None:
    for kind, item in ITEMS:
        with subtests.test(item.name):
            meta = item.metadata
            assert set(meta) == {"symbol", "unit", "source", "low", "high", "meaning", "choices", "live"}
            bad: list[tuple[object, str]] = []
            if isinstance(item.default, bool):
                bad = [(value, "must be true or false, got") for value in (1, "on", None)]
            else:
                assert meta["low"] <= item.default <= meta["high"]
                bad = [(value, "must be from .* to .*, got") for value in (meta["low"] - 1, meta["high"] + 1)]
                bad += [(math.nan, "must be"), *((odd, "must be a number from") for odd in (True, "fast", None))]
            for value, reason in bad:
                with pytest.raises(ValueError, match=f"{item.name} {reason}"):
                    kind(**{item.name: value})


def test_whole_numbers_stay_whole() -> None:
    with pytest.raises(ValueError, match=r"image_width must be a whole number from 8 to 640, got 64\.5"):
        SimParams(image_width=64.5)  # type: ignore[arg-type]


def test_rates_must_divide() -> None:
    with pytest.raises(ValueError, match=r"physics_rate_hz must be a multiple of sensor_rate_hz \(7\), got 240"):
        replace(SimParams(), sensor_rate_hz=7)


def test_the_least_patience_is_at_most_the_most() -> None:
    with pytest.raises(ValueError, match=r"patience_least_s must be at most patience_most_s \(8\), got 9"):
        OfficeParams(patience_least_s=9.0)
    with pytest.raises(ValueError, match=r"patience_least_s must be at most patience_most_s \(2\.5\), got 3"):
        OfficeParams(patience_most_s=2.5)
    assert OfficeParams(patience_least_s=8.0).patience_most_s == 8.0

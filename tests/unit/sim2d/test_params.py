from __future__ import annotations

import math
from dataclasses import fields, replace

import pytest

from sim2d import SimParams


def test_defaults_are_the_ones_asked_for() -> None:
    p = SimParams()
    assert (p.physics_rate_hz, p.sensor_rate_hz, p.substeps, p.tick_s) == (240, 10, 24, 0.1)
    assert (p.odometry_noise, p.odometry_scale_error) == (0.05, 0.02)
    assert math.degrees(p.gyro_bias) == pytest.approx(0.2)
    assert math.degrees(p.camera_fov_rad) == pytest.approx(50)


@pytest.mark.parametrize("item", fields(SimParams), ids=lambda item: item.name)
def test_every_number_is_declared_in_full_and_checked(item) -> None:
    meta = item.metadata
    assert set(meta) == {"symbol", "unit", "source", "low", "high", "meaning", "choices", "live"}
    assert meta["low"] <= item.default <= meta["high"]
    for bad in (meta["low"] - 1, meta["high"] + 1):
        with pytest.raises(ValueError, match=rf"{item.name} must be from .* to .*, got {bad!r}"):
            SimParams(**{item.name: bad})
    with pytest.raises(ValueError, match=f"{item.name} must be"):
        SimParams(**{item.name: math.nan})
    for odd in (True, "fast", None):
        with pytest.raises(ValueError, match=f"{item.name} must be a number from"):
            SimParams(**{item.name: odd})


def test_whole_numbers_stay_whole() -> None:
    with pytest.raises(ValueError, match=r"image_width must be a whole number from 8 to 640, got 64\.5"):
        SimParams(image_width=64.5)  # type: ignore[arg-type]


def test_rates_must_divide() -> None:
    with pytest.raises(ValueError, match=r"physics_rate_hz must be a multiple of sensor_rate_hz \(7\), got 240"):
        replace(SimParams(), sensor_rate_hz=7)

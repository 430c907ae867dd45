"""Where cameras stand: they look down at their plates, past what lies on the stage, and fly from one view to another."""

from __future__ import annotations

import math

import numpy as np
import pytest

from web.viewer.camera_views import FLIGHT_S, VIEWS, Camera, Flight, camera_for, seen_by
from web.viewer.fits.cell_fit import HEIGHT


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("aspect", [0.46, 1.0, 1.2, 2.2])
def test_every_view_looks_down_at_its_plate(view: str, aspect: float) -> None:
    camera = camera_for(view, aspect)  # type: ignore[arg-type]
    assert camera.position[2] > camera.look_at[2] + 5
    assert camera.position[1] < camera.look_at[1]
    assert 10 < np.linalg.norm(camera.position - camera.look_at) < 250


@pytest.mark.parametrize(("aspect", "top", "two"), [(1.55, 0.09, False), (3.0, 0.2, False), (3.0, 0.2, True)])
def test_the_plates_stand_below_the_buttons(aspect: float, top: float, two: bool) -> None:
    """The row of buttons takes a twelfth of a desk's stage, and a fifth of that of a phone on its side."""
    camera = camera_for("all", aspect, two=two)
    corners = [(x * 3.5, 8.5 + y * 3.5, HEIGHT) for x in (-1, 1) for y in (-1, 1)]  # of the pose cells' box
    if two:
        corners = [(x + at, y, z) for x, y, z in corners for at in (-10.4, 10.4)]
    half = math.tan(camera.fov_rad / 2) * float(np.linalg.norm(camera.position - camera.look_at))
    highest = seen_by(camera, np.array(corners))[0][:, 1].max() / half
    assert (1 - highest) / 2 >= top - 0.005


def test_a_flight_begins_and_ends_where_it_should() -> None:
    start, end = Camera(np.zeros(3), np.ones(3), 0.5), Camera(np.ones(3), np.zeros(3), 0.6)
    flight = Flight(start, end, 10.0)
    camera, arrived = flight.at(10.0)
    assert not arrived
    assert np.allclose(camera.position, 0)
    camera, arrived = flight.at(10.01 + FLIGHT_S)
    assert arrived
    assert np.allclose(camera.position, 1)
    assert camera.fov_rad == pytest.approx(0.6)

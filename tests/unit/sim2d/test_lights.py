"""What the camera makes of lamps, daylight, glass and its own lens."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim2d import Daylight, Event, Lamp, OfficeParams, Simulator, Wall

from .rooms import EXACT, STAY, room, run, wall


def brightness(simulator: Simulator) -> float:
    return float(run(simulator, STAY, 1).image.mean())


def test_lamps_and_daylight_change_what_the_camera_sees() -> None:
    lamp = Lamp("ceiling", 3.0, 2.0, 3.0, 0.8, on=False)
    dark = room(daylight=Daylight((0.0, 10.0), (0.3, 1.0)), lamps=(lamp,))
    simulator = Simulator(dark, EXACT)
    first = brightness(simulator)
    assert first == pytest.approx(0.3 * brightness(Simulator(room(), EXACT)), rel=0.05)
    simulator.set_lamp("ceiling", True)
    lit = brightness(simulator)
    assert lit > 1.5 * first
    simulator.set_lamp("ceiling", False)
    run(simulator, STAY, 50)
    assert brightness(simulator) > 1.8 * first  # the sun has risen
    night = Simulator(dark, EXACT, office=OfficeParams(daylight=False))
    run(night, STAY, 50)
    assert brightness(night) == pytest.approx(first, rel=0.05)
    script = (Event(0.5, "daylight", level=2.0), Event(1.0, "lamp_on", "ceiling"))
    scripted = Simulator(replace(dark, script=script), EXACT)
    run(scripted, STAY, 6)
    assert brightness(scripted) > 4 * first


def test_no_lamp_shines_through_a_wall() -> None:
    dark = room(wall(3.0, 0.0, 3.0, 4.0), daylight=Daylight((0.0,), (0.2,)))
    lit = replace(dark, lamps=(Lamp("behind", 3.5, 2.0, 3.0, 0.9),))
    assert np.array_equal(Simulator(lit, EXACT).observe().image, Simulator(dark, EXACT).observe().image)


def test_glass_mirrors_and_lets_see_through() -> None:
    def image(pane: tuple[Wall, ...], behind: Wall, on: bool = True) -> np.ndarray:
        world = room(*pane, behind, wall(0.5, 1.0, 0.5, 3.0, colour=(250, 40, 40)))
        return Simulator(world, EXACT, office=OfficeParams(reflections=on)).observe().image[20, 32].astype(float)

    blue, green = (wall(3.8, 1.0, 3.8, 3.0, colour=c) for c in ((40, 40, 250), (40, 250, 40)))
    pane = wall(3.0, 1.0, 3.0, 3.0, kind="glass", colour=(200, 220, 230), reflection=0.3)
    bare, glass, pale = image((), blue), image((pane,), blue), image((pane,), blue, on=False)
    assert glass[2] < bare[2]  # less comes through
    assert glass[0] > bare[0] + 10  # and the red wall behind the robot shows in it
    assert glass[1] < pale[1]
    assert image((pane,), green)[1] > glass[1] + 50
    full = image((replace(pane, reflection=1.0),), blue)
    assert np.array_equal(full, image((replace(pane, reflection=1.0),), green))


def test_a_panorama_sees_all_around() -> None:
    red, green = wall(3.0, 1.5, 3.0, 2.5, colour=(250, 0, 0)), wall(1.5, 3.0, 2.5, 3.0, colour=(0, 250, 0))
    blue = wall(1.0, 1.5, 1.0, 2.5, colour=(0, 0, 250))
    params = replace(EXACT, camera_fov_rad=2 * math.pi, image_width=128)
    row = Simulator(room(red, green, blue), params).observe().image[24].astype(int)
    assert row[64].argmax() == 0
    assert row[32].argmax() == 1  # a quarter to the left
    assert row[0].argmax() == row[127].argmax() == 2


def test_lens_and_resolution_change_while_it_runs() -> None:
    simulator = Simulator(room(), EXACT)
    wide = replace(EXACT, camera_fov_rad=1.5, image_width=96, image_height=40, camera_height_m=0.8, exposure_gain=0.5)
    for params in (wide, replace(wide, fade_m=3.0)):
        simulator.set_params(params)
        assert np.array_equal(run(simulator, STAY, 1).image, Simulator(room(), params).observe().image)

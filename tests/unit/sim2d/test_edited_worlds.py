"""An edit touches only what is new. Afterwards everything is as if the edited world had been loaded from its file."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from sim2d import Drive, FreeSpace, Lamp, OfficeParams, Panel, SensorFrame, Simulator, Wall, World, load_world
from sim2d.geometry.grid_cells import connected
from sim2d.world.world_check import Fault, check_world
from sim2d.world.world_file import world_from_json
from sim2d.world.world_schema import WorldText, world_to_json

from . import rooms
from .rooms import room, wall

RADIUS = 0.22
SIDE = 5.0
EXACT = replace(rooms.EXACT, laser_beams=31)
STILL = OfficeParams(people=False)  # after an edit, they draw from another generator


@st.composite
def some_wall(draw: st.DrawFn, low: float = 0.05, high: float = SIDE - 0.05) -> Wall:
    """A wall anywhere within, of any kind, sometimes with a picture on it; some hang above the robot."""
    x1, y1, x2, y2 = (draw(st.floats(low, high)) for _ in range(4))
    kind = draw(st.sampled_from(["wall", "partition", "desk", "glass"]))
    bottom = draw(st.sampled_from([0.0, 0.0, 0.0, 0.8]))
    x2 += 0.1 if (x1, y1) == (x2, y2) else 0.0
    drawn = wall(x1, y1, x2, y2, kind=kind, height=1.6, bottom=bottom)
    if drawn.length > 0.5 and draw(st.booleans()):
        side = draw(st.sampled_from(["left", "right", "both"]))
        return replace(
            drawn, panels=(Panel(0.1, 0.3, bottom, 1.5, "poster", (200, 60, 40), draw(st.integers(0, 9)), side),)
        )
    return drawn


def changed(draw: st.DrawFn, world: World) -> World:
    """The world with one to three inner walls drawn, changed or removed; all others are the same objects."""
    walls, first = list(world.walls), sum(w.outer for w in world.walls)
    for _ in range(draw(st.integers(1, 3))):
        k = draw(st.integers(first, len(walls)))
        match draw(st.sampled_from(["add", "add", "change", "delete"])):
            case "add":
                walls.insert(k, draw(some_wall()))
            case "change" if k < len(walls):
                walls[k] = draw(some_wall())
            case "delete" if k < len(walls):
                del walls[k]
    return replace(world, walls=tuple(walls))


@st.composite
def some_history(draw: st.DrawFn) -> list[World]:
    worlds = [room(*draw(st.lists(some_wall(), max_size=8)), side=SIDE)]
    for _ in range(draw(st.integers(1, 4))):
        undone = len(worlds) > 1 and draw(st.integers(0, 4)) == 0
        worlds.append(worlds[-2] if undone else changed(draw, worlds[-1]))
    return worlds


@settings(max_examples=150)
@given(some_history(), st.sampled_from([0.05, 0.13]))
@pytest.mark.slow
def test_where_the_robot_fits_after_edits(worlds: list[World], cell_m: float) -> None:
    free = None
    for world in worlds:
        free = FreeSpace(world, RADIUS, cell_m, before=free)
        assert np.array_equal(floor(free, cell_m), floor(FreeSpace(world, RADIUS, cell_m), cell_m))


def floor(space: FreeSpace, cell_m: float) -> np.ndarray:
    """The cells that can be reached: from which one comes to some cell without driving."""
    covered = np.zeros(space.grid, np.bool_)
    space.cover(covered, (np.argwhere(~covered)[:, ::-1] + 0.5) * cell_m, 0.0)
    return covered


@settings(max_examples=150)
@given(st.data())
@pytest.mark.slow
def test_reachable_cells_are_those_of_the_seeds_components(data: st.DataObject) -> None:
    shape = data.draw(st.tuples(st.integers(1, 12), st.integers(1, 12)))
    free = np.random.default_rng(data.draw(st.integers(0, 999))).random(shape) < data.draw(st.floats(0.1, 0.9))
    seeds = np.argwhere(free)[: data.draw(st.integers(0, 3))]
    numbers = label(free, structure=np.ones((3, 3)))[0]
    assert np.array_equal(connected(free, seeds), np.isin(numbers, [numbers[tuple(s)] for s in seeds]))


def same(a: SensorFrame, b: SensorFrame) -> bool:
    return all(np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(SensorFrame))


def drive_both(edited: Simulator, anew: Simulator, seed: int, ticks: int) -> None:
    """The same drives from the same places must give the same frames and the same path, bit for bit."""
    rng, space = np.random.default_rng(seed), anew.free_space
    for tick in range(ticks):
        if tick % 25 == 0:
            place = (*space.random_point(rng), float(rng.uniform(-3, 3)))
            for simulator in (edited, anew):
                simulator.teleport(*place)
            assert same(replace(edited.observe(), tick=0), replace(anew.observe(), tick=0))
        if tick % 8 == 0:
            drive = Drive(float(rng.uniform(-0.3, 0.5)), float(rng.uniform(-1.5, 1.5)))
        assert same(edited.step(drive), anew.step(drive))
        assert edited.truth == anew.truth


def edit_all(simulator: Simulator, worlds: list[World]) -> None:
    """Edit as the editor does. A world that is not valid is refused, and everything stays as it is."""
    for world in worlds:
        try:
            check_world(world, RADIUS, simulator.world, simulator.free_in)
            simulator.set_world(world)
        except (Fault, ValueError):
            continue


@settings(max_examples=60)
@given(some_history())
def test_the_text_after_edits(worlds: list[World]) -> None:
    text = WorldText()
    for world in worlds:
        assert text.of(world) == world_to_json(world)


@settings(max_examples=40)
@given(some_history(), st.integers(0, 999))
@pytest.mark.slow
def test_all_senses_and_the_drive_after_edits(worlds: list[World], seed: int) -> None:
    lamps = (Lamp("a", 1.2, 1.0, 1.5, 0.6), Lamp("b", 4.0, 4.2, 2.5, 0.4))
    edited = Simulator(room(side=SIDE, lamps=lamps), EXACT, 1, STILL)
    edited.step(Drive(0.0, 0.0))  # its camera has painted what it sees
    edit_all(edited, [replace(world, lamps=lamps) for world in worlds])
    anew = Simulator(world_from_json(world_to_json(edited.world), "written.json"), EXACT, 1, STILL)
    anew.step(Drive(0.0, 0.0))
    drive_both(edited, anew, seed, 50)


@pytest.mark.parametrize("name", ["living", "suburb"])
@pytest.mark.slow
def test_edits_of_a_large_and_of_a_living_world(name: str) -> None:
    """In a large world all texels grow with its walls; a living one has moving walls after the others."""
    world, rng = load_world(name), np.random.default_rng(3)
    edited = Simulator(world, EXACT, 1, STILL)
    x0, y0, x1, y1 = world.bounds
    for _ in range(12):
        now = edited.world
        inner = [k for k, wall in enumerate(now.walls) if not wall.outer]
        k, (x, y) = int(rng.choice(inner)), rng.uniform((x0, y0), (x1 - 1, y1 - 1))
        drawn = replace(now.walls[k], x1=x, y1=y, x2=x + now.walls[k].length, y2=y)
        more = (*now.walls, drawn) if rng.random() < 0.5 else (*now.walls[:k], drawn, *now.walls[k + 1 :])
        edit_all(edited, [replace(now, walls=more)])
        edited.step(Drive(0.1, 0.3))
    assert edited.world.walls != world.walls
    anew = Simulator(world_from_json(world_to_json(edited.world), "written.json"), EXACT, 1, STILL)
    for _ in range(12):
        anew.step(Drive(0.1, 0.3))
    drive_both(edited, anew, 5, 100)
    for other in (edited.world, world):  # another run in it and in the one before: what is taken over changes nothing
        again, anew = Simulator(other, EXACT, 2, before=edited), Simulator(other, EXACT, 2)
        assert again.digest() == anew.digest()
        drive_both(again, anew, 7, 60)
        assert again.digest() == anew.digest()

"""The office's speed: `ratslam bench`, after the engine's rows. Worlds are grids of open rooms of 4 x 4 m."""

from __future__ import annotations

import math
import statistics
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from app.session import Session
from app.views.office import world_drawing
from app.world_editor import WorldEditor
from sim2d import Drive, Person, Place, Simulator, Start, Wall, World, load_world, world_to_json
from sim2d.importers.plan import Dresser
from web.messages import EditWorld

Row = dict[str, Any]
ROOM_M, GAP_M = 4.0, 1.4
WARM_TICKS, TICKS, LOOP_S, EDITS = 50, 1500, 60.0, 20
FASTEST = 300  # times real time that the closed loop has to be


def rows(quick: bool = False) -> Iterator[Row]:
    """The rows, each as soon as it has been measured. quick: the largest world is a small one, to see that all of it works."""
    for walls, bar in ((100, 0.15), (400, 0.2), (2000, 0.3)):
        ms = tick_ms(Simulator(rooms(walls), seed=1))
        yield _row("office: one 10 Hz tick", f"{walls:,} walls", ms, f"{bar:g} ms", ms <= bar)
    yield _closed_loop()
    ms = edit_ms(Session(rooms(2000), 1))
    yield _row("office: one wall drawn, the tick after it", "2,000 walls", ms, "50 ms", ms <= 50)
    yield from _largest(*((100, 2) if quick else (10_000, 50)))


def rooms(walls: int, people: int = 0, seed: int = 0) -> World:
    """A world of so many walls with pictures on them, in which people walk round in rooms."""
    across = math.ceil(0.5 + math.sqrt(0.25 + (walls - 4) / 2))  # 2 n (n - 1) walls between n x n rooms
    side, dresser = across * ROOM_M, Dresser(seed)
    outline = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)]
    made: list[Wall] = dresser.line(outline, "left", outer=True)
    for row in range(across):
        for column in range(1, across):
            a, b = column * ROOM_M, row * ROOM_M
            for x1, y1, x2, y2 in ((a, b, a, b + ROOM_M - GAP_M), (b, a, b + ROOM_M - GAP_M, a)):
                if len(made) < walls:
                    made += dresser.line([(x1, y1), (x2, y2)], "each")
    rng = np.random.default_rng(seed)
    middle = (across // 2 + 0.5) * ROOM_M
    walkers: list[Person] = []
    for k in range(people):
        x, y = (rng.integers(0, across, 2) + 0.5) * ROOM_M
        ring = tuple((float(x + dx), float(y + dy)) for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
        walkers.append(Person(f"person {k}", ring, (1.0,) * 4))
    world = World(
        f"rooms-{walls}", f"{walls} walls", "benchmark", tuple(made), (Start("home", middle, middle, 0.0),),
        (Place("home", middle, middle),),
    )  # fmt: skip
    return replace(world, people=tuple(walkers))


def tick_ms(simulator: Simulator, seed: int = 0) -> float:
    """Median time (ms) of a tick of physics, camera (64 x 48), sonars and encoders while the robot drives at random."""
    rng = np.random.default_rng(seed)
    times: list[float] = []
    drive = Drive(0.0, 0.0)
    for tick in range(WARM_TICKS + TICKS):
        if tick % 20 == 0:
            drive = Drive(float(rng.uniform(-0.2, 0.5)), float(rng.uniform(-1.2, 1.2)))
        began = time.perf_counter()
        simulator.step(drive)
        times.append(time.perf_counter() - began)
    return 1e3 * statistics.median(times[WARM_TICKS:])


def edit_ms(session: Session) -> float:
    """Median time (ms) of an edit in the engine's thread: check, change, drawing for the viewer, next tick."""
    times: list[float] = []
    editor, simulator = WorldEditor(session.world), session.simulator
    radius, number = simulator.params.robot_radius_m, len(session.world.walls) - 1
    for k in range(EDITS):
        x, y = simulator.truth.x + 1.0, simulator.truth.y + 1.0
        item = {"from": [x, y], "to": [x + 0.5, y + 0.01 * k]}
        step = {"do": "change", "list": "walls", "number": number, "item": item}
        order = EditWorld.model_validate({"type": "edit_world", "steps": [step]})
        began = time.perf_counter()
        editor.edit(order, radius, session.edit_world, simulator.free_in)
        world_drawing(session.world, radius, simulator.params.camera_fov_rad)
        session.tick()
        times.append(time.perf_counter() - began)
    return 1e3 * statistics.median(times)


def _closed_loop() -> Row:
    """The default office after its first minute, the best of four half minutes. A tick may take 0.1 s / 300."""
    session = Session(load_world(), 1)
    ticks = round(LOOP_S / session.frame.dt)
    for _ in range(ticks):
        session.tick()
    ms = math.inf
    for _ in range(4):
        began = time.perf_counter()
        for _ in range(ticks // 2):
            session.tick()
        ms = min(ms, 1e3 * (time.perf_counter() - began) / (ticks // 2))
    size = f"default office: {1e3 * session.frame.dt / ms:.0f} x real time"
    bar = 1e3 * session.frame.dt / FASTEST
    return _row("office: headless closed loop, tick", size, ms, f"{bar:.3f} ms ({FASTEST} x)", ms <= bar)


def _largest(walls: int, people: int) -> Iterator[Row]:
    """The largest world that is allowed: from its file to the first frame, and a tick of it live."""
    size = f"{walls:,} walls, {people} people"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "large.json"
        file.write_text(world_to_json(rooms(walls, people)), encoding="utf-8")
        loads: list[tuple[float, Session]] = []
        for _ in range(3):
            began = time.perf_counter()
            session = Session(load_world(file), 1)
            loads.append((1e3 * (time.perf_counter() - began), session))
        ms, session = min(loads[0][0], loads[1][0], loads[2][0]), loads[2][1]
    yield _row("office: loading a world", size, ms, "3000 ms", ms <= 3000)
    times: list[float] = []
    for _ in range(600):
        began = time.perf_counter()
        session.tick()
        times.append(1e3 * (time.perf_counter() - began))
    worst = max(sum(times[k : k + 10]) for k in range(5, len(times) - 10)) / 10
    yield _row("office: tick, in the worst second", size, worst, "100 ms (x1)", worst <= 100)
    ms = edit_ms(session)
    yield _row("office: one wall drawn, the tick after it", size, ms, "100 ms", ms <= 100)


def _row(work: str, size: str, ms: float, bar: str, holds: bool) -> Row:
    return {
        "work": work, "size": size, "ms": round(ms, 4), "reference": "-", "reference_ms": None, "bar": bar,
        "holds": bool(holds),
    }  # fmt: skip

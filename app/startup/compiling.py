"""The first start. numba compiles each kernel at its first call and caches it on disk. All kernels together take half a
minute of one core, so separate processes compile them side by side and report their progress.

Called with the names of parts, this module is the first of these processes: it uses each part of the program for a moment in
one of its own, forked when everything has been imported, and prints an empty line for each kernel. Nothing else depends on
what is computed here.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import chain
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numba.core import config as numba_config
from numba.core.dispatcher import Dispatcher
from numba.core.event import Event, Listener, register  # pyright: ignore[reportUnknownVariableType]

import app.pilot.bars
import app.pilot.known_ground
import app.pilot.local_movement
import ratslam_core.experience_map.places
import ratslam_core.extensions.evidence
import ratslam_core.extensions.odometry_edges
import ratslam_core.extensions.scan_matching
import ratslam_core.goal_memory
import ratslam_core.local_view.echo_matcher
import ratslam_core.local_view.front_ends.image_and_sonars
import ratslam_core.local_view.matcher
import ratslam_core.local_view.view_links
import ratslam_core.occupancy_grid
import ratslam_core.pose_cells.activity_kernels
import ratslam_core.pose_cells.attractor_kernels
import ratslam_core.pose_cells.packet_kernels
import ratslam_core.pose_graph.relaxation
import ratslam_core.solvers.dijkstra
import ratslam_core.solvers.laplacian
import sim2d.camera.painting
import sim2d.geometry.grid_cells
import sim2d.sensors
from app.config import Config
from app.evaluation import Coverage
from app.pilot import Pilot
from app.pilot.bars import Bars
from app.pilot.known_ground import KnownGround
from app.pilot.local_movement import LocalMovement
from app.pilot.route_following import RouteFollower
from disk import kernel_cache
from ratslam_core import (
    ExperienceMap,
    GoalMemory,
    LocalView,
    MapGrid,
    OccupancyGrid,
    Odometry,
    Packet,
    Pose2,
    PoseCells,
    Recognition,
    ViewLinks,
    find_places,
)
from ratslam_core.extensions.familiar_ground import FamiliarGround
from ratslam_core.extensions.kidnap_detector import ScanChange
from ratslam_core.extensions.scan_matching import ScanMatching
from ratslam_core.pose_cells.activity_kernels import X, Y
from ratslam_live import command_of
from sim2d import SONAR_ANGLES_RAD, Drive, Simulator, load_world

if TYPE_CHECKING:
    from app.engine_thread import EngineThread  # loaded while others compile

WORDS = "compiling the engine for this machine, once"

_ANGLES = np.array(SONAR_ANGLES_RAD)
_RANGES = np.full(len(_ANGLES), 2.0)


class Compiling:
    """Begins at once to compile the parts whose kernels are not on disk. A part that fails is compiled when used."""

    def __init__(self) -> None:
        if kernel_cache.words:
            print(f"ratslam: {kernel_cache.words}", file=sys.stderr)
        keeps = not (kernel_cache.in_memory or numba_config.DISABLE_JIT)  # pyright: ignore[reportAttributeAccessIssue,reportUnknownMemberType]
        missing = [part for part, (_, modules) in PARTS.items() if keeps and not all(map(is_compiled, modules))]
        self._process = _process(missing) if missing else None

    def __bool__(self) -> bool:
        """Whether there was anything to do."""
        return self._process is not None

    def wait(self, progress: Callable[[str], None]) -> None:
        """Wait until everything is compiled or `stop` is called. progress: is called with it in words."""
        if self._process is None:
            return
        assert self._process.stdout is not None
        for done, _ in enumerate(self._process.stdout, start=1):
            progress(f"{WORDS}: {done} {'function' if done == 1 else 'functions'} done")
        if sys.stderr.isatty():
            print(file=sys.stderr)

    def stop(self) -> None:
        """End it at once. What has been compiled is kept, and `wait` returns."""
        if self._process is not None and self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


def _process(parts: list[str]) -> subprocess.Popen[str]:
    """The compiling process. It leads a process group of its own, so that its children can be ended with it."""
    return subprocess.Popen(
        command_of("app.startup.compiling", *parts),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, process_group=0,
    )  # fmt: skip


def say_how_far(words: str) -> None:
    """Show progress on one line of a terminal. Nothing is written to a log file, where it would take many lines."""
    if sys.stderr.isatty():
        print(f"\r{words} ", end="", file=sys.stderr, flush=True)


def is_compiled(module: ModuleType) -> bool:
    """Whether numba has cached a kernel of this module that is not older than the source."""
    source = Path(str(module.__file__))
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in kept(module))


def kept(module: ModuleType) -> list[Path]:
    """Where numba keeps what it knows of the kernels of this module."""
    items: list[Any] = [item for item in vars(module).values() if isinstance(item, Dispatcher)]
    kernel = next(item for item in items if item.py_func.__module__ == module.__name__)
    return [*Path(str(kernel.stats.cache_path)).glob(f"{Path(str(module.__file__)).stem}.*.nbi")]


def date(modules: Iterable[ModuleType]) -> None:
    """Their kernels fit their sources as they are now: numba goes by the text, and `is_compiled` by dates alone."""
    for index in chain.from_iterable(map(kept, modules)):
        index.touch()


def office() -> None:
    """The simulator, and the pilot's local movement."""
    config = Config()
    simulator = Simulator(load_world(), config.robot, 1, config.office)
    pilot = Pilot(config.pilot, _ANGLES, np.random.default_rng(1))
    cells = config.pose_cells
    nowhere = ExperienceMap((cells.n_theta, cells.n_y, cells.n_x), cells.cell_m, config.experience_map)
    frame = simulator.observe()
    Coverage().follow(simulator.free_space, np.zeros((1, 2)))
    local = LocalMovement(_ANGLES, config.pilot.echo_s)
    local.free_way(0.0, config.pilot)
    local.sense(np.full(len(_ANGLES), 0.2, np.float32), Odometry(0.0, 0.0, 0.1))
    local.gap_towards(1.0, 0.2, config.pilot)
    for _ in range(50):
        odometry = Odometry(frame.odometry_speed, frame.odometry_yaw_rate, frame.dt)
        frame = simulator.step(Drive(*pilot.step(frame.ranges_m, frame.bumped, odometry, nowhere)))
    for _ in range(300):
        if simulator.step(Drive(0.4, 0.0)).bumped:  # what touches a wall moves by other kernels
            break


def cells() -> None:
    """Views, pose cells with two packets, and the links between them."""
    config = Config()
    rng = np.random.default_rng(1)
    local_view, links = LocalView(config.local_view, rng), ViewLinks(config.local_view)
    pose_cells, jump = PoseCells(config.pose_cells), ScanChange()
    images = rng.integers(0, 256, (4, 8, 12), dtype=np.uint8).repeat(6, axis=1).repeat(6, axis=2)
    for k in range(60):
        seen = local_view.observe(images[k // 5 % 4], None, _RANGES, 0.02)
        local_view.difference_to(0)
        jump.observe(_RANGES + k % 2)
        pose_cells.integrate(0.03, 0.02)
        links.learn(seen.view, *pose_cells.active, pose_cells.slot, config.local_view.learning_rate)
        where, strength = links.recall(seen.view)
        pose_cells.inject(where.copy(), strength)
        if k == 30:
            far = (where + np.int32(20)) % np.int32(min(pose_cells.shape))
            pose_cells.inject(np.ascontiguousarray(far, np.int32), strength)
        pose_cells.attract()
    for view in range(300):  # more than the arena has room for at first: compiles its growth
        links.learn(view, *pose_cells.active, pose_cells.slot)


def maps() -> None:
    """The goal memory and the occupancy grids."""
    config = Config()
    cells = config.pose_cells
    shape = (cells.n_theta, cells.n_y, cells.n_x)
    goals = GoalMemory(config.goal_memory, shape, cells.cell_m)
    grid = OccupancyGrid(shape, cells.cell_m, _ANGLES)
    pictures = MapGrid(_ANGLES)
    for k in range(10):
        grid.update(Packet(k % 5 * 4.0, 4.0, 0.0, 1.0), _RANGES)
        pictures.add(k, Pose2(0.0, 0.0, 0.0), _RANGES)
    blob = np.zeros((64, 4), np.int32)
    for k in range(3):  # more links than there is room for at first: compiles the growth
        blob[:, X], blob[:, Y] = np.arange(64) % 8 + 8 * k, np.arange(64) // 8
        goals.learn(blob, np.ones(64, np.float32), 0.1 * k)
    goals.direction(goals.times_to(20, 4), Packet(4.0, 4.0, 0.0, 1.0))


def loops() -> None:
    """The experience map with closed loops, and the routes through it."""
    config = Config()
    cells = config.pose_cells
    shape = cells.n_theta, cells.n_y, cells.n_x
    believes = replace(config.experience_map, submaps=False)  # else it would doubt that it is now here, now there
    made = ExperienceMap(shape, cells.cell_m, believes, ground=FamiliarGround())
    for k in range(600):
        view, known = k // 10 % 20, k >= 200
        packet = Packet(view % 5 * 4.0, view // 5 * 4.0, 0.0, 1.0)
        seen = Recognition(view, not known and k % 10 == 0, view if known else -1, 2.0)
        created = made.step(packet, seen, Odometry(0.3, 0.1, 0.1))
        made.ground.note(made, seen, created, Odometry(0.3, 0.1, 0.1), False)
        made.correct()
    made.temporal_map.times_to(0)
    made.step(Packet(30.0, 30.0, 0.0, 1.0), Recognition(99, True, -1, 2.0), Odometry(0.3, 0.1, 0.1))
    made.temporal_map.times_to(0)  # is mended now
    rng, seen_by = np.random.default_rng(1), LocalView(config.local_view)
    for _ in range(20):
        seen_by.observe(rng.integers(0, 256, (48, 64), np.uint8), None, _RANGES)
    made.params = config.experience_map
    made.declare_kidnapped()
    ratslam_core.extensions.evidence.nats(0.5, 0)
    ratslam_core.extensions.odometry_edges.open_way_m(made.transitions, 0, 1)
    scans = ScanMatching(_ANGLES)
    for k in range(100):  # so far that the first were made before the way here
        scans.sense(_RANGES, Odometry(1.5, 0.0, 0.1), 1)
        scans.made(k)
    scans.verified(made, 0, Pose2(0.0, 0.0, 0.0))
    for _ in range(9):
        made.evidence.move(Odometry(0.3, 0.1, 0.1))
        made.evidence.observe(made, seen_by, made.submaps.current, scans)
    local, bars = LocalMovement(_ANGLES, config.pilot.echo_s), Bars()
    bars.add(made.robot, 0.0, config.pilot)
    RouteFollower(0, bars).step(made, local, 0.1, config.pilot)
    ground = KnownGround(_ANGLES)
    ground.step(made, _RANGES, 0.1, 0.1)
    ground.openings(made)
    find_places(made)


# With each part, the modules whose kernels it compiles last: once these are on disk, the whole part is.
PARTS: dict[str, tuple[Callable[[], None], tuple[Any, ...]]] = {
    "office": (office, (sim2d.geometry.grid_cells, sim2d.camera.painting, sim2d.sensors, app.pilot.local_movement)),
    "cells": (cells, (ratslam_core.pose_cells.activity_kernels, ratslam_core.pose_cells.attractor_kernels,
                      ratslam_core.pose_cells.packet_kernels,
                      ratslam_core.local_view.front_ends.image_and_sonars, ratslam_core.local_view.echo_matcher,
                      ratslam_core.local_view.matcher, ratslam_core.local_view.view_links)),
    "loops": (loops, (ratslam_core.pose_graph.relaxation, ratslam_core.solvers.laplacian, ratslam_core.solvers.dijkstra,
                      ratslam_core.extensions.evidence, ratslam_core.extensions.odometry_edges,
                      ratslam_core.extensions.scan_matching, ratslam_core.experience_map.places, app.pilot.bars,
                      app.pilot.known_ground)),
    "maps": (maps, (ratslam_core.goal_memory, ratslam_core.occupancy_grid)),
}  # fmt: skip


class _Count(Listener):
    """Prints a line when a kernel has been compiled. Kernels that it calls are counted with it."""

    def __init__(self) -> None:
        self._depth = 0

    def on_start(self, event: Event) -> None:  # noqa: ARG002
        self._depth += 1

    def on_end(self, event: Event) -> None:  # noqa: ARG002
        self._depth -= 1
        if self._depth == 0:
            print(flush=True)


class EngineStarter:
    """Starts the engine when its kernels are compiled, from a thread of its own. The page shows the progress."""

    def __init__(self, engine: EngineThread, compiling: Compiling) -> None:
        self._engine, self._compiling = engine, compiling
        self._stopped = False
        self._thread = threading.Thread(target=self._wake, name="waking", daemon=True)

    def start(self) -> None:
        if self._compiling:
            print(f"RatSLAM wakes up: {WORDS}, some twenty seconds if nothing else runs ...", flush=True)
        self._thread.start()

    def stop(self, patience_s: float | None = None) -> None:
        """End the engine, or what precedes its start. patience_s: how long to wait for the current tick."""
        self._stopped = True
        self._compiling.stop()
        self._thread.join()
        self._engine.stop(patience_s)

    def _wake(self) -> None:
        self._compiling.wait(self._show_progress)
        self._engine.latest.waking = "loading the office and the brain"
        if not kernel_cache.in_memory:
            _load_kernels()
        if not self._stopped:
            self._engine.start()

    def _show_progress(self, words: str) -> None:
        self._engine.latest.waking = words
        say_how_far(words)


def _load_kernels() -> None:
    """While there are descriptors: whoever connects may take the last. What cannot be loaded, the engine meets and tells of."""
    for use, _ in PARTS.values():
        with contextlib.suppress(Exception):
            use()


if __name__ == "__main__":
    register("numba:compile", _Count())
    gc.disable()  # saves an eighth of the time; the process is short-lived, so its garbage does no harm
    for part in sys.argv[1:]:
        if os.fork() == 0:
            use, modules = PARTS[part]
            use()
            date(modules)
            break
    else:
        for _ in sys.argv[1:]:
            os.wait()

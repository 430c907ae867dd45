"""Brains and whole sessions that were spoilt and signed again, and what one that is accepted all the same is made to do."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Callable
from functools import cache, cached_property
from random import Random
from typing import Any

import numpy as np

from app.config import Config
from app.protocol.steps import spread_goals
from app.session import Session
from app.session_snapshot import read_session, take_session
from disk import State, write_state
from ratslam_core import RatSlam, find_places, take_snapshot
from ratslam_core.brain_file import read_brain
from sim2d import load_world
from tests.fuzz.mutators import bytes_spoilt, text_of, tree_spoilt

WORLD = "loop"
ROBOTS: tuple[dict[str, Any], ...] = (
    {},
    {"local_view.front_end": "complex cells", "pose_cells.n_x": 16, "pose_cells.n_y": 13, "pose_cells.n_theta": 10},
    {"experience_map.shortcut_m": 1.0, "experience_map.solve_every": 5, "local_view.rest": 0.0},
)


class Files:
    """Files of states, spoilt, and what is done with one that can be read."""

    def __init__(self, make: Callable[[], tuple[State, ...]], use: Callable[[bytes], str], as_zip: float) -> None:
        self._make, self.use, self._as_zip = make, use, as_zip

    @cached_property
    def bases(self) -> tuple[State, ...]:
        return self._make()

    @cached_property
    def packed(self) -> tuple[bytes, ...]:
        return tuple(file_of(base.tree, base.arrays) for base in self.bases)

    def file(self, rng: Random) -> str:
        """One with other bytes."""
        data, other = rng.choice(self.packed), rng.choice(self.packed)
        return self.use(_zip_spoilt(data, rng) if rng.random() < self._as_zip else bytes_spoilt(data, rng, other))

    def state(self, rng: Random) -> str:
        """One with another state, and a digest that fits."""
        return self.use(file_of(*state_of(rng.choice(self.bases), rng)))

    def warm(self) -> None:
        """Compile whatever a case needs, so that later only the case's own time is measured."""
        for data in self.packed:
            self.use(data)


def _brains() -> tuple[State, ...]:
    """Brains that have driven, been carried off and learnt."""
    return tuple(
        take_snapshot(_driven(WORLD, Config().with_values(robot), {200: Session.kidnap}, 250).brain) for robot in ROBOTS
    )


def _sessions() -> tuple[State, ...]:
    """Sessions that have driven, been carried off, and are on their way to a goal."""
    orders = {120: Session.kidnap, 180: lambda session: session.pilot.set_goal(spread_goals(session, 1)[0])}
    return tuple(take_session(_driven(world, Config(), orders, 220)) for world in ("living", WORLD))


def _driven(world: str, config: Config, orders: dict[int, Callable[[Session], object]], ticks: int) -> Session:
    session = Session(load_world(world), 2, config)
    for tick in range(ticks):
        orders.get(tick, lambda _: None)(session)
        session.tick()
    return session


def state_of(base: State, rng: Random) -> tuple[Any, list[np.ndarray]]:
    """The state with another tree or with some other arrays."""
    tree: Any = base.tree
    arrays = [array.copy() for array in base.arrays]
    if rng.random() < 0.4:
        tree = tree_spoilt(tree, rng)
    if rng.random() < 0.8:
        for _ in range(rng.choice((1, 1, 2, 4))):
            at = rng.randrange(len(arrays))
            arrays[at] = _array_spoilt(arrays[at], rng, arrays)
    return tree, arrays


def _use_brain(data: bytes) -> str:
    """Wake up with the brain, drive a little, and ask it for routes. Returns what became of it."""
    brain = read_brain(io.BytesIO(data))
    session = Session(load_world(WORLD), 1, Config().with_engine(brain.params), brain, before())
    for tick in range(12):
        if tick == 6:
            _ask(brain)
        session.tick()
    _ask(brain)
    take_snapshot(brain).digest()
    return "taken"


def _use_session(data: bytes) -> str:
    """Go on with the session, partly by hand and after a kidnap, and save it again. Returns what became of it."""
    session = read_session(io.BytesIO(data))
    for tick in range(12):
        if tick == 4:
            session.pilot.drive(0.3, -0.5)
        if tick == 8:
            session.kidnap()
            session.set_mode("explore")
        session.tick()
    session.state_hash()
    write_state(take_session(session), io.BytesIO())
    return "taken"


BRAINS, SESSIONS = Files(_brains, _use_brain, as_zip=0.3), Files(_sessions, _use_session, as_zip=0.0)


@cache
def before() -> Session:
    return Session(load_world(WORLD), 1)


def _ask(brain: RatSlam) -> None:
    map_, n = brain.experience_map, len(brain.experience_map)
    for goal in {0, n // 2, n - 1}:
        map_.temporal_map.times_to(goal)
        for start in {0, n - 1, map_.active}:
            map_.temporal_map.route(start, goal)
    _, n_y, n_x = brain.pose_cells.shape
    times = brain.goal_memory.times_to(n_x // 2, n_y // 2)
    brain.goal_memory.direction(times, brain.pose_cells.winner)
    find_places(map_)
    if brain.map_grid is not None:
        brain.map_grid.draw(map_.poses)
    for view in {0, len(brain.local_view) - 1} - {-1}:
        brain.view_links.of(view)
        brain.view_links.views_at(3, n_y * n_x, len(brain.local_view))
        brain.local_view.difference_to(view)
    map_.residual, map_.link_times, brain.pose_cells.activity, brain.pose_cells.packets  # noqa: B018


def file_of(tree: Any, arrays: list[np.ndarray]) -> bytes:
    """The file of a state, with its digest if it can be computed, else with the digest of nothing."""
    out = io.BytesIO()
    if isinstance(tree, dict) and "nested " not in (text := json.dumps(tree)) and "NaN" not in text:
        try:
            write_state(State(tree, arrays), out)
            return out.getvalue()
        except ValueError:
            out = io.BytesIO()
    named: dict[str, Any] = {f"a{k}": array for k, array in enumerate(arrays)}
    np.savez(out, json=np.frombuffer(text_of(tree).encode(), np.uint8), **named)
    return out.getvalue()


def _array_spoilt(array: np.ndarray, rng: Random, arrays: list[np.ndarray]) -> np.ndarray:
    seed = np.random.default_rng(rng.randrange(2**32))
    match rng.randrange(12):
        case 0:
            return array[: rng.randrange(len(array) + 1)] if array.ndim else np.zeros(3)
        case 1:
            return np.concatenate([array, array]) if array.ndim else array.astype(np.int8)
        case 2:
            kinds = (np.int64, np.float64, np.int32, np.float32, np.uint8, np.bool_, np.complex64)
            with np.errstate(invalid="ignore"):  # nan becomes some number
                return array.astype(rng.choice(kinds))
        case 3:
            return array.T if rng.random() < 0.5 else array.ravel()
        case 4:
            return array[None] if rng.random() < 0.5 else np.zeros_like(array)
        case 5:
            return rng.choice(arrays)
        case 6 if array.ndim:
            return seed.permutation(array)
        case 7:
            return np.frombuffer(seed.bytes(array.nbytes), array.dtype).reshape(array.shape)
        case 8:
            return np.zeros((1 << rng.choice((4, 16, 20)), *array.shape[1:2]), array.dtype)
    used = np.flatnonzero(array.ravel()) if rng.random() < 0.7 else np.arange(array.size)
    if array.size and len(used):
        at = seed.choice(used, min(len(used), rng.choice((1, 1, 3, 50))))
        array.reshape(-1)[at] = _value(array.dtype, array.size, rng)
    return array


def _value(kind: np.dtype, size: int, rng: Random) -> Any:
    if kind.kind == "f":
        return rng.choice((np.nan, np.inf, -np.inf, 1e30, -1.0, 0.0, 1e-30, -1e18, 3.0, 1e7))
    if kind.kind == "b":
        return rng.random() < 0.5
    limits = np.iinfo(kind)
    wish = rng.choice((limits.min, limits.max, -1, 0, 1, size, size - 1, 2 * size, rng.randrange(size), 100, 2**31 - 1))
    return min(max(wish, limits.min), limits.max)


def _zip_spoilt(data: bytes, rng: Random) -> bytes:
    """A valid but odd zip file: encrypted, packed in another way, headers that claim more, too many entries."""
    kind = rng.randrange(6)
    if kind < 2:  # flags or method of one entry, in its own header and in the directory
        entries = zipfile.ZipFile(io.BytesIO(data)).infolist()
        chosen, out = rng.choice(entries), bytearray(data)
        field, value = ((6, 1), (8, rng.choice((1, 9, 12, 14, 93))))[kind]
        struct.pack_into("<H", out, chosen.header_offset + field, value)
        at = data.find(b"PK\x01\x02")
        while at >= 0:
            if struct.unpack_from("<I", data, at + 42)[0] == chosen.header_offset:
                struct.pack_into("<H", out, at + field + 2, value)
            at = data.find(b"PK\x01\x02", at + 4)
        return bytes(out)
    with zipfile.ZipFile(io.BytesIO(data)) as old:
        parts = {entry.filename: old.read(entry) for entry in old.infolist()}
    name = rng.choice(list(parts))
    if kind == 2:
        parts[name] = parts[name].replace(b"(", rng.choice((b"(99999999999,", b"(-1,", b"((" * 30, b"(0,")), 1)
    elif kind == 3:
        parts[name] = parts[name][:128] + bytes(rng.choice((1 << 20, 1 << 26)))
    elif kind == 4:
        parts |= {f"b{k}.npy": b"" for k in range(rng.choice((1, 3000)))}
    else:
        parts[name] = bytes_spoilt(parts[name], rng)
    out_file = io.BytesIO()
    with zipfile.ZipFile(out_file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as new:
        for part, content in parts.items():
            new.writestr(part, content)
    return out_file.getvalue()

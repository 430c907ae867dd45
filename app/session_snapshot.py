"""A whole session as a state and as a file: office, robot, brain, pilot and evaluation. A restored one goes on bit for
bit.

Two worlds are kept as the texts of their files and checked like any world file: the one that a reset begins in, and the
one that the robot is in, where boxes may have been put down. The rest must keep the laws in session_laws. The brain stands
in front: it can be read alone, also where another version knows the rest no more.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import IO, cast

import numpy as np

from app import session_laws
from app.orders import SMALLEST_M
from app.session import Session
from disk import State, copy_state, decode, encode
from disk.archive import BROKEN
from disk.state_file import load_as, read_as, save_state
from disk.state_reading import words_of
from ratslam_core import RatSlam
from ratslam_core.brain_file import restore_snapshot
from ratslam_core.laws.measures import array
from sim2d import World, world_from_json


def take_session(session: Session) -> State:
    """The whole state, as a copy: the session may go on."""
    return state_of(session.source.world_texts, copy_state(session))


def restore_session(state: State) -> Session:
    """A session in this state. It uses the state's arrays, not copies. ValueError says what is wrong with the state."""
    try:
        return _settled(state)
    except BROKEN as error:
        raise ValueError(words_of(error)) from None


def save_session(session: Session, path: Path | str) -> None:
    """Write a session to one file (.npz: arrays, and JSON as bytes). After a failure the file is as it was before.

    OSError names the file. ValueError: the session is too large to be read again.
    """
    save_state(take_session(session), path)


def load_session(path: Path | str, begun: Session | None = None) -> Session:
    """The session that `save_session` wrote. begun: of a recording: another one that plays it. Of its session no laws are
    checked. ValueError names the file and what is wrong with it."""
    return load_as("session", path, partial(_settled, begun=begun))


def read_session(file: IO[bytes]) -> Session:
    """The session in an open file. ValueError says what is wrong with it."""
    return read_as("session", file, _settled)


def state_of(world_texts: tuple[str, str], copy: Session) -> State:
    """From a copy of a session (`disk.copy_state`) and its `world_texts`."""
    return encode((copy.brain, *(np.frombuffer(text.encode(), np.uint8) for text in world_texts), copy))


def load_its_brain(path: Path | str) -> RatSlam:
    """The brain in the file of a session, or of a brain alone. ValueError names the file and what is wrong with it."""
    return load_as("brain", path, _its_brain)


def _its_brain(state: State) -> RatSlam:
    whole = state.tree.get("state")
    parts = cast("dict[str, list[object]]", whole).get("tuple") if isinstance(whole, dict) else None
    return restore_snapshot(State({**state.tree, "state": parts[0]}, state.arrays) if parts else state)


def _settled(state: State, begun: Session | None = None) -> Session:
    parts = decode(state)
    if not isinstance(parts, tuple) or len(cast("tuple[object, ...]", parts)) not in (3, 4):  # 3: earlier programs
        raise ValueError("it must hold two worlds and a session")
    first_text, text, session = cast("tuple[object, ...]", parts)[-3:]
    if not isinstance(session, Session):
        raise ValueError(f"it must hold a session, got a {type(session).__name__}")
    if begun is not None:
        session.settle((), begun)
        return session
    first = _world_of(first_text, "the text of its first world")
    now = _world_of(text, "the text of its world", begins=False)
    if first == now:
        first = now
    session_laws.check(session, now)
    session.settle((first, now))
    return session


def _world_of(text: object, name: str, *, begins: bool = True) -> World:
    text = array(name, text, np.uint8, (None,))
    return world_from_json(text.tobytes().decode(), "its world", SMALLEST_M, begins=begins)

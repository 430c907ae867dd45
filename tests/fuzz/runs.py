"""Kept runs that were spoilt: their lines, signed again or not, and the brain and the state beside them."""

from __future__ import annotations

import base64
import contextlib
import io
import json
import os
import tempfile
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random

from app.cli.command_line import main
from app.config import Config
from app.engine.engine import Engine
from app.engine.pace import Pace
from app.engine.watchdog import Watchdog
from app.run_record.folder import BRAIN, LINES, STATE
from app.run_record.header import beginning_of, header_of, written
from app.run_record.order_rows import edit_of
from app.run_record.reader import open_run
from app.run_record.record import tick_checksum
from app.run_record.resume import replayed, resumed
from app.run_record.run_log import LogFile, RunLog
from app.run_record.writer import RunKeeper
from app.session import Session
from app.session_snapshot import read_session, take_session
from disk import State, encode, write_state
from ratslam_core.brain_file import read_brain
from sim2d import Box, load_world, world_to_json
from tests.fuzz.mutators import bytes_spoilt, text_of, tree_spoilt
from tests.fuzz.states import file_of, state_of

TICKS = 40
LONG = 1_000_000  # bytes of a line; to spoil a longer one once more would take more memory than to read it may
Files = dict[str, bytes]
BOMBS = (
    lambda: b"[" + b"[]," * 5_000_000 + b"[]]", lambda: b'"' + b"a" * 17_000_000 + b'"', lambda: b"9" * 4_000_000,
    lambda: b"[" * 1_000_000, lambda: b'{"tick":0,"end":[' + b"{}," * 1_000_000 + b"0]}",
)  # fmt: skip


def run_file(rng: Random) -> str:
    """Spoil a run; list it, run it again, go on with it, and keep on keeping it. Returns what became of it."""
    files = dict(rng.choice(bases()))
    for _ in range(rng.choice((1, 1, 2))):
        name = rng.choice([name for name in (LINES, LINES, LINES, STATE, BRAIN) if name in files])
        files[name] = _lines_spoilt(files[name], rng) if name == LINES else _state_spoilt(files, name, rng)
    return use(files)


@cache
def bases() -> tuple[Files, ...]:
    """Short runs with a box, an edit of the world, a kidnap, another parameter and driving by hand; one began with a brain."""
    return _kept(False), _kept(True)


def _kept(with_brain: bool) -> Files:
    before = Session(load_world("loop"), 4)
    for _ in range(60 if with_brain else 0):
        before.tick()
    with tempfile.TemporaryDirectory() as home:
        folder, brain = Path(home) / "run", None
        log_file = LogFile(folder)
        if with_brain:
            with (folder / BRAIN).open("wb") as file:
                write_state(encode(before.brain), file)
            brain = read_brain(io.BytesIO((folder / BRAIN).read_bytes()))
        session = Session(load_world("loop"), 2, Config(), brain)
        log_file.add(written(header_of(beginning_of(session, brain=brain))))
        lines = RunLog(log_file, session.source.world_texts[0])
        session.on_order = lines.order
        for tick in range(1, TICKS + 1):
            session.tick()
            lines.tick(tick, tick_checksum(session))
            if tick in (20, 35):
                lines.hash(tick, session.state_hash(), len(session.brain.experience_map))
            if tick == 20:
                with (folder / STATE).open("wb") as file:
                    write_state(take_session(session), file)
            ORDERS.get(tick, lambda _: None)(session)
        lines.flush()
        log_file.close()
        return {path.name: path.read_bytes() for path in folder.iterdir()}


ORDERS: dict[int, Callable[[Session], object]] = {
    5: lambda session: session.put_box(Box("crate", 2.0, 2.0, 0.4, 0.4, 0.5, 0.2)),
    10: Session.kidnap,
    15: lambda session: session.edit_world(load_world("loop")),
    22: lambda session: session.set_parameter("pose_cells.inhibit", 0.0003),
    30: lambda session: session.set_mode("manual"),
    31: lambda session: session.drive(0.2, 0.3),
}


def _lines_spoilt(data: bytes, rng: Random) -> bytes:
    """Other bytes; or other lines, with checksums that fit."""
    if rng.random() < 0.2:
        return bytes_spoilt(data, rng, rng.choice(bases())[LINES])
    texts = [line.split(b" ", 1)[-1] for line in data.splitlines()]
    for _ in range(rng.choice((1, 1, 2, 5))):
        at, other = rng.randrange(len(texts)), rng.randrange(len(texts))
        match rng.randrange(10):
            case 0:
                texts[at:at] = [texts[other]] * (rng.choice((1, 1, 500)) if len(texts[other]) < LONG else 1)
            case 1:
                texts[at], texts[other] = texts[other], texts[at]
            case 2 if len(texts) > 1:
                del texts[at]
            case 3:
                texts[at] = bytes_spoilt(texts[at], rng, texts[other]).replace(b"\n", b"")
            case 4 if rng.random() < 0.1:
                texts[at] = rng.choice(BOMBS)()
            case 5:
                ticks = rng.choice((1, 10, 1000, 2_000_000))
                pulses = base64.b64encode(bytes(4 * ticks)).decode()
                texts[at:at] = [json.dumps({"tick": TICKS + ticks, "pulses": pulses}).encode()]
            case 6:
                world = world_to_json(load_world("loop"))
                edit = edit_of(world, json.dumps(tree_spoilt(json.loads(world), rng), indent=1))
                order = {"tick": TICKS, "order": "edit_world", "values": {}, "edit": edit}  # the last of the run
                texts[at:at] = [json.dumps(order).encode()]
            case _ if len(texts[at]) < LONG:
                with contextlib.suppress(ValueError, RecursionError):  # spoilt before
                    texts[at] = text_of(tree_spoilt(json.loads(texts[at]), rng)).encode("utf-8", "surrogatepass")
    return signed(texts)


def signed(texts: list[bytes]) -> bytes:
    """A file of these lines, with their checksums."""
    out, check = b"", 0
    for text in texts:
        check = zlib.crc32(text, check)
        out += b"%08x %s\n" % (check, text)
    return out


def _state_spoilt(files: Files, name: str, rng: Random) -> bytes:
    """The file with other bytes, or with another state whose digest fits, and which the run's hashes know."""
    data = files[name]
    if rng.random() < 0.3 or len(data) < 100:
        return bytes_spoilt(data, rng) if data else b"x"
    whole = _states()[name]
    spoilt = file_of(*state_of(rng.choice(whole), rng))
    if name == STATE:
        with contextlib.suppress(Exception):  # one that cannot be read has no hash
            session = read_session(io.BytesIO(spoilt))
            texts = [line.split(b" ", 1)[-1] for line in files[LINES].splitlines()]
            hash_ = {"tick": session.tick_count, "hash": session.state_hash(), "experiences": 3}
            files[LINES] = signed([*texts, json.dumps(hash_).encode()])
    return spoilt


@cache
def _states() -> dict[str, tuple[State, ...]]:
    first, second = bases()
    sessions = [read_session(io.BytesIO(files[STATE])) for files in (first, second)]
    return {
        STATE: tuple(take_session(session) for session in sessions),
        BRAIN: (encode(read_brain(io.BytesIO(second[BRAIN]))),),
    }


def use(files: Files) -> str:
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home) / "run"
        folder.mkdir()
        for name, data in files.items():
            (folder / name).write_bytes(data)
        os.environ["RATSLAM_RUNS"] = home
        _list()
        run = open_run(folder)
        refused: ValueError | None = None
        try:
            replayed(run)
        except ValueError as error:
            refused = error
            _require_sentence(error)
        there = resumed(run)
        _go_on(folder, there)
        if refused is not None:
            raise refused
    return "taken"


def _list() -> None:
    for words in (["runs"], ["runs", "--json"]):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            assert main(words) == 0
        lines = said.getvalue().splitlines()
        assert len(lines) == (2 if len(words) == 1 else 1), lines
        for line in lines:
            assert len(line) < 2000, line
            assert line.isprintable(), line
            line.encode()


def _go_on(folder: Path, session: Session) -> None:
    """What `ratslam run --resume` does with it."""
    kept, complaints = open_run(folder), list[str]()
    keeper = RunKeeper(complaints.append)
    engine = Engine(session.world, Pace(1.0), Watchdog(60.0, lambda: None), running=True, answer=_nobody, keeper=keeper)
    keeper.start()
    try:
        engine.go_on(kept, session)
        for _ in range(3):
            engine.tick()
    finally:
        keeper.stop()
    again = open_run(folder)
    assert complaints or engine.fault is not None or again.tick == kept.tick + 3, again.tick
    for words in complaints:
        _require_sentence(ValueError(words))


def _require_sentence(error: ValueError) -> None:
    words = str(error)
    assert words, repr(error)
    assert len(words) < 2000, words
    assert "\n" not in words.strip(), words


def _nobody(_request: object, _answer: object) -> None:
    pass


def warm() -> None:
    """Compile whatever a case needs."""
    for files in bases():
        assert use(files) == "taken"

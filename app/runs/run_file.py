"""A run as it was kept: what it began from, each order with its tick, a pulse of each tick, a hash of the state now and
then. It is enough to run it again, bit for bit."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from app.order_book import SMALLEST_M, Order, carry_out, overtakes
from app.runs.folder import BRAIN, LINES, all_runs, runs_folder
from app.runs.header import SIZE, Header, edited, read_header, require_room
from app.runs.journal import Lines
from disk.state_reading import words_of
from disk.words import one_line

if TYPE_CHECKING:
    from app.session import Session


MOST_WORDS, MOST_EXPERIENCES = 200, 10**9


@dataclass(slots=True)
class KeptRun:
    """A run up to its last whole line.

    last_tick: the last tick that is known to have been run. end: why the run ended; empty when it was cut off.
    pulses: SIZE bytes for each tick from the first on. hashes: of the state after a tick, before the orders given then.
    again: ticks at which another program went on with it, and its version. damage: what is wrong at the end of the file.
    """

    folder: Path
    header: Header
    orders: list[Order] = field(default_factory=list[Order])
    last_tick: int = 0
    experiences: int | None = None
    pulses: bytearray = field(default_factory=bytearray)
    hashes: dict[int, str] = field(default_factory=dict[int, str])
    again: list[tuple[int, str]] = field(default_factory=list[tuple[int, str]])
    end: str = ""
    damage: str = ""
    size: int = 0  # bytes and checksum up to the last whole line
    check: int = 0
    world_text: str = ""  # as last edited
    edited_bytes: int = 0  # of all texts of edited worlds

    @property
    def name(self) -> str:
        return self.folder.name

    @property
    def length_s(self) -> float:
        """Simulated seconds, if the rate of ticks was never changed."""
        if self.header.recording is not None:
            return self.last_tick * self.header.recording.dt
        return self.last_tick / float(self.header.values.get("robot.sensor_rate_hz", 10.0))

    @property
    def left_at(self) -> float:
        """When its last line was written, seconds since 1970."""
        return (self.folder / LINES).stat().st_mtime

    def begin(self) -> Session:
        """The session before its first tick. ValueError says why it cannot begin."""
        from app.runs.replay import recorded
        from app.session import Session
        from ratslam_core import load_brain
        from sim2d import world_from_json

        header = self.header
        if header.recording is not None:
            return recorded(self.name, header)
        world = world_from_json(header.world, f"the world of {self.name}", SMALLEST_M)
        brain = load_brain(self.folder / BRAIN) if header.brain else None
        return Session(world, header.seed, header.config, brain)

    def play(self, until: int | None = None, session: Session | None = None) -> Iterator[Session]:
        """Run it again. Yields the session before its first tick and after each tick; the orders of a tick are carried out
        right after that.

        until: the last tick, by default that of the run. session: one of this run to go on from, before the orders of its
        tick. ValueError: an order cannot be carried out again.
        """
        session = self.begin() if session is None else session
        until = self.last_tick if until is None else min(until, self.last_tick)
        orders = iter([order for order in self.orders if order.tick >= session.tick_count])
        following = next(orders, None)
        while True:
            yield session
            while following is not None and following.tick == session.tick_count:
                _again(session, following)
                following = next(orders, None)
            if session.tick_count >= until or session.source.over:
                return
            session.tick()

    def pulse(self, tick: int) -> bytes:
        return bytes(self.pulses[SIZE * (tick - 1) : SIZE * tick])


def open_run(name: str | Path) -> KeptRun:
    """A run by its id, by `last`, or by the path of its folder or file. ValueError says why it cannot be opened."""
    folder = _found(name)
    lines = Lines(folder / LINES)
    values = iter(lines)
    try:
        first = next(values, None)
        if first is None:
            raise ValueError(f"{lines.path} is no run: it does not begin with a whole line")
        run = _begun(folder, first, lines.path)
        for line in values:
            try:
                _take(run, line)
            except (ValueError, TypeError, KeyError, AttributeError) as error:
                raise ValueError(f"{lines.path}, line {lines.count}: {words_of(error)}") from None
    except OSError as error:
        raise ValueError(f"{lines.path}: {error.strerror or error}") from None
    run.damage, run.size, run.check = lines.damage, lines.size, lines.check
    return run


def _begun(folder: Path, line: dict[str, Any], path: Path) -> KeptRun:
    try:
        header = read_header(line)
    except ValueError as error:
        raise ValueError(f"{path} is no run that can be read: {error}") from None
    return KeptRun(folder, header, world_text=header.world)


def _found(name: str | Path) -> Path:
    if name == "last":
        runs = all_runs()
        if not runs:
            raise ValueError(f"no run is kept in {runs_folder()}")
        return runs[0]
    path = Path(name)
    for folder in (path, path.parent if path.name == LINES else path, runs_folder() / path):
        if (folder / LINES).is_file():
            return folder
    raise ValueError(f"there is no run {str(name)!r}: give an id as `ratslam runs` lists them, `last`, or a file")


def _take(run: KeptRun, line: dict[str, Any]) -> None:
    """Take in one line. ValueError, TypeError, KeyError: it is not one that a run writes."""
    tick = line["tick"]
    if type(tick) is not int:
        raise ValueError(f"a tick must be a whole number, got {str(tick)[:40]!r}")
    if "pulses" in line:
        pulses = base64.b64decode(line["pulses"], validate=True)
        if not pulses or len(pulses) % SIZE or tick != run.last_tick + len(pulses) // SIZE:
            raise ValueError(f"it has {len(pulses)} bytes for the ticks from {run.last_tick + 1} to {tick}")
        run.pulses += pulses
        run.last_tick = tick
        return
    if "hash" in line and 0 <= tick <= run.last_tick:
        known = line["experiences"]
        if type(known) is not int or not 0 <= known <= MOST_EXPERIENCES:
            raise ValueError(f"experiences must be a whole number from 0 on, got {str(known)[:40]!r}")
        run.hashes[tick], run.experiences = _words(line["hash"]), known
        return
    if tick != run.last_tick:
        raise ValueError(f"it is of tick {tick}, after tick {run.last_tick}")
    if "order" in line:
        values = line["values"]
        if not isinstance(values, dict):
            raise ValueError(f"the values of an order must be an object, got {str(values)[:40]!r}")
        if "edit" in line:
            run.world_text = values["world"] = edited(run.world_text, line["edit"])
            run.edited_bytes += len(run.world_text)
        _order(run, Order(tick, _words(line["order"]), cast("dict[str, Any]", values)))
    elif "again" in line:
        run.again.append((tick, _words(line["again"])))
        run.end = ""
    else:
        run.end = _words(line["end"])


def _order(run: KeptRun, order: Order) -> None:
    """Earlier programs also wrote what the next order undid, or repeated."""
    if run.orders and overtakes(order, run.orders[-1]):
        run.orders.pop()
    run.orders.append(order)
    require_room(len(run.orders), run.edited_bytes)


def _words(value: object) -> str:
    if not isinstance(value, str) or len(value) > MOST_WORDS:
        raise ValueError(f"it must hold a line of at most {MOST_WORDS} characters, got {str(value)[:40]!r}")
    return one_line(value)


def _again(session: Session, order: Order) -> None:
    from app.runs.order_check import check_order  # it looks at the session's methods, and those load all kernels

    try:
        check_order(order)
        carry_out(session, order)
    except ValueError as error:
        raise ValueError(f"tick {order.tick}: the order {order.name} cannot be carried out again: {error}") from None

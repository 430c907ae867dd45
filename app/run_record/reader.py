"""A run as it was kept in its folder: a record of it, a checksum of each tick, a hash of the state now and then, and how it
ended."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from app.orders import Order
from app.run_record.folder import BRAIN, LINES, all_runs, runs_folder
from app.run_record.header import Beginning, read_header
from app.run_record.order_rows import OrderRows
from app.run_record.record import CHECKSUM_BYTES, RunRecord
from app.run_record.run_log import Lines
from disk.state_reading import words_of
from disk.words import one_line

if TYPE_CHECKING:
    from ratslam_core import RatSlam

MOST_WORDS, MOST_EXPERIENCES = 200, 10**9


@dataclass(slots=True)
class KeptRun(RunRecord):
    """A run up to its last whole line.

    end: why the run ended; empty when it was cut off. checksums: CHECKSUM_BYTES for each tick from the first on. hashes: of
    the state after a tick, before the orders given then. again: ticks at which another program went on with it, and its
    version. damage: what is wrong at the end of the file.
    """

    folder: Path
    rows: OrderRows
    experiences: int | None = None
    checksums: bytearray = field(default_factory=bytearray)
    hashes: dict[int, str] = field(default_factory=dict[int, str])
    again: list[tuple[int, str]] = field(default_factory=list[tuple[int, str]])
    end: str = ""
    damage: str = ""
    size: int = 0  # bytes and checksum up to the last whole line
    check: int = 0

    @property
    def name(self) -> str:
        return self.folder.name

    @property
    def length_s(self) -> float:
        """Simulated seconds, if the rate of ticks was never changed."""
        if self.header.recording is not None:
            return self.tick * self.header.recording.dt
        return self.tick / float(self.header.values.get("robot.sensor_rate_hz", 10.0))

    @property
    def left_at(self) -> float:
        """When its last line was written, seconds since 1970."""
        return (self.folder / LINES).stat().st_mtime

    def first_brain(self) -> RatSlam | None:
        from ratslam_core import load_brain

        return load_brain(self.folder / BRAIN) if self.header.brain else None

    @property
    def beginning(self) -> Beginning:
        header, brain = self.header, self.folder / BRAIN if self.header.brain else None
        return Beginning(header.world, header.world_name, header.seed, header.config, brain, header.trial)

    def checksum(self, tick: int) -> bytes:
        return bytes(self.checksums[CHECKSUM_BYTES * (tick - 1) : CHECKSUM_BYTES * tick])


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
    rows = OrderRows(header.world)
    return KeptRun(header, rows.orders, 0, folder, rows)


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
        checksums = base64.b64decode(line["pulses"], validate=True)
        ticks, odd = divmod(len(checksums), CHECKSUM_BYTES)
        if ticks == 0 or odd or tick != run.tick + ticks:
            raise ValueError(f"it has {len(checksums)} bytes for the ticks from {run.tick + 1} to {tick}")
        run.checksums += checksums
        run.tick = tick
        return
    if "hash" in line and 0 <= tick <= run.tick:
        known = line["experiences"]
        if type(known) is not int or not 0 <= known <= MOST_EXPERIENCES:
            raise ValueError(f"experiences must be a whole number from 0 on, got {str(known)[:40]!r}")
        run.hashes[tick], run.experiences = _words(line["hash"]), known
        return
    if tick != run.tick:
        raise ValueError(f"it is of tick {tick}, after tick {run.tick}")
    if "order" in line:
        values = line["values"]
        if not isinstance(values, dict):
            raise ValueError(f"the values of an order must be an object, got {str(values)[:40]!r}")
        run.rows.add(Order(tick, _words(line["order"]), cast("dict[str, Any]", values)), line.get("edit"))
    elif "again" in line:
        run.again.append((tick, _words(line["again"])))
        run.end = ""
    else:
        run.end = _words(line["end"])


def _words(value: object) -> str:
    if not isinstance(value, str) or len(value) > MOST_WORDS:
        raise ValueError(f"it must hold a line of at most {MOST_WORDS} characters, got {str(value)[:40]!r}")
    return one_line(value)

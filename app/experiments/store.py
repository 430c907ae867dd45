"""Trials and their scores in one SQLite file. Trajectories are not kept: the same trial runs again, bit for bit.

All of a trial is kept as text, from which it can be made again even when its experiment's file has changed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import sqlite3
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from app.code_version import code_version
from app.protocol.steps import Step
from app.protocol.trial import Result, Trial, text_of
from disk import user_folder
from disk.locks import require_record_locks

VERSION = 1  # of these tables, kept as the file's user_version
BUSY_S = 60.0  # how long a command that writes waits for another that does
READ_BUSY_S = 0.5  # and one that only reads: the file's journal lets it read meanwhile, unless somebody locks it whole
_AT_ONCE = 500  # ids in one question

_TABLES = """
CREATE TABLE definitions (
    digest TEXT PRIMARY KEY,    -- of the text; the trials of a cell share it
    text TEXT NOT NULL          -- JSON: all of a trial but its seed
) WITHOUT ROWID;
CREATE TABLE trials (
    id TEXT PRIMARY KEY,        -- hash of version, protocol, world, config, seed and what is measured
    experiment TEXT NOT NULL,
    engine TEXT NOT NULL,
    levels TEXT NOT NULL,       -- JSON: of each axis, by label
    seed INTEGER NOT NULL,
    version TEXT NOT NULL,      -- of the code
    quick INTEGER NOT NULL,
    world TEXT NOT NULL,
    definition TEXT NOT NULL REFERENCES definitions (digest),
    simulated_s REAL NOT NULL,
    wall_s REAL NOT NULL,
    state_hash TEXT NOT NULL,
    moment_s REAL NOT NULL,     -- when it was decided, simulated
    moment TEXT NOT NULL,       -- and by what
    error TEXT NOT NULL,        -- empty, or why the trial failed; it then has no scores and is run again
    made_at TEXT NOT NULL       -- UTC
) WITHOUT ROWID;
CREATE INDEX trials_by_experiment ON trials (experiment);
CREATE TABLE scores (
    trial TEXT NOT NULL REFERENCES trials (id) ON DELETE CASCADE,
    name TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (trial, name)
) WITHOUT ROWID;
"""
_COLUMNS = "id, engine, levels, seed, moment_s, moment, simulated_s, wall_s, error, version, quick"
# "OR IGNORE" would also pass over a row that lacks a value
_INSERT = f"INSERT INTO trials VALUES ({', '.join('?' * 16)}) ON CONFLICT (id) DO NOTHING"
_MADE_AGAIN = "SELECT text, seed FROM trials JOIN definitions ON digest = definition WHERE substr(id, 1, ?) = ? LIMIT 2"
_STEPS: TypeAdapter[tuple[Step, ...]] = TypeAdapter(tuple[Step, ...])


@dataclass(frozen=True, slots=True)
class Outcome:
    """How the trial with this id ended. Exactly one of result and error is given."""

    trial_id: str
    result: Result | None = None
    error: str = ""  # in words


@dataclass(frozen=True, slots=True)
class StoredTrial:
    """A trial that was run, and its scores. One that failed has an error, no scores, and is run again by the next command."""

    id: str
    engine: str
    levels: tuple[str, ...]  # of each axis, by label
    seed: int
    scores: dict[str, float]
    moment_s: float  # simulated time of the moment that decided the trial
    moment_words: str
    simulated_s: float = 0.0
    wall_s: float = 0.0
    error: str = ""
    version: str = ""  # of the code
    quick: bool = False


def default_path() -> Path:
    """ValueError without a home."""
    return user_folder("experiments.sqlite")


class Store:
    """One process writes; others may read and, when it is their turn, write as well."""

    def __init__(self, path: Path | None = None, *, reading: bool = False) -> None:
        """reading: nothing is added, and nobody waited for; the file must exist then. ValueError, here and from everything that
        is asked of it: the file cannot be made or read, or is something else."""
        self.path = path or default_path()
        self._db = _opened(self.path) if reading else connected(self.path)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._db.close()

    def add(self, ended: Iterable[tuple[Trial, Outcome]]) -> int:
        """Keep these trials, all or none, and return how many are new. A trial that is kept already stays as it is."""
        with self._transaction():
            return sum(self._add(trial, outcome) for trial, outcome in ended)

    def _add(self, trial: Trial, outcome: Outcome) -> bool:
        result, error = outcome.result, outcome.error
        self._db.execute("DELETE FROM trials WHERE id = ? AND error != ''", (trial.id,))
        row = (
            trial.id, trial.experiment, trial.engine, json.dumps(trial.levels), trial.seed, trial.version, trial.quick,
            trial.world, self._definition(trial),
            *((result.simulated_s, result.wall_s, result.state_hash, result.deciding.time_s, result.deciding.words)
              if result else (0.0, 0.0, "", 0.0, "")),
            error, datetime.now(UTC).isoformat(timespec="seconds"),
        )  # fmt: skip
        if not self._db.execute(_INSERT, row).rowcount:
            return False
        if result is not None:
            scores = [(trial.id, name, value) for name, value in result.scores.items() if math.isfinite(value)]
            self._db.executemany("INSERT INTO scores VALUES (?, ?, ?)", scores)
        return True

    def _definition(self, trial: Trial) -> str:
        """The digest of a definition that is in the file."""
        text = _definition_of(trial)
        digest = hashlib.sha256(text.encode()).hexdigest()[:16]
        self._db.execute("INSERT OR IGNORE INTO definitions VALUES (?, ?)", (digest, text))
        return digest

    @contextlib.contextmanager
    def _transaction(self) -> Generator[None]:
        try:
            self._db.execute("BEGIN IMMEDIATE")
            yield
            self._db.execute("COMMIT")
        except BaseException as error:
            with contextlib.suppress(sqlite3.Error):  # SQLite may have done so
                self._db.execute("ROLLBACK")
            if isinstance(error, sqlite3.OperationalError):
                raise ValueError(
                    f"{self.path}: {error}; what was kept before is safe, and the same command goes on"
                ) from None
            if isinstance(error, sqlite3.DatabaseError) and not isinstance(error, sqlite3.IntegrityError):
                raise _broken(self.path, error) from None
            raise

    def done(self, ids: Iterable[str]) -> set[str]:
        """Which of these trials have scores."""
        return {row[0] for row in self._asked("SELECT id FROM trials WHERE error = '' AND id IN", list(ids))}

    def stored(self, trials: Sequence[Trial]) -> list[StoredTrial]:
        """Those of these trials that were run, in their order. One that two experiments or cells share counts in both."""
        ids = list({trial.id for trial in trials})
        rows = {row[0]: row for row in self._asked(f"SELECT {_COLUMNS} FROM trials WHERE id IN", ids)}
        scores = self._scores(list(rows))
        return [_stored(rows[trial.id], scores, trial.engine, trial.levels) for trial in trials if trial.id in rows]

    def of_experiment(self, name: str) -> list[StoredTrial]:
        """All trials ever run for an experiment, by any version of the program."""
        order = "ORDER BY made_at, engine, levels, seed"
        rows = self._ask(f"SELECT {_COLUMNS} FROM trials WHERE experiment = ? {order}", (name,))
        scores = self._scores([row[0] for row in rows])
        return [_stored(row, scores, row[1], tuple(json.loads(row[2]))) for row in rows]

    def counts(self) -> dict[str, int]:
        """How many trials each experiment has that did not fail."""
        return dict(self._ask("SELECT experiment, count(*) FROM trials WHERE error = '' GROUP BY experiment"))

    def seconds(self, name: str, quick: bool) -> dict[str, float]:
        """Wall seconds of a trial of this experiment, on average, by engine; measured on whatever machine it ran."""
        rows = self._ask(
            "SELECT engine, avg(wall_s) FROM trials WHERE experiment = ? AND quick = ? AND error = '' GROUP BY engine",
            (name, quick),
        )
        return dict(rows)

    def trial(self, trial_id: str) -> Trial:
        """The trial with this id, or whose id alone begins so. ValueError lists ids that are close."""
        rows = self._ask(_MADE_AGAIN, (len(trial_id), trial_id))
        if len(rows) == 1 and trial_id:
            return _trial_from(*rows[0])
        raise ValueError(self._unknown(trial_id, several=len(rows) > 1))

    def moment(self, trial_id: str) -> tuple[float, str]:
        """When a trial was decided (simulated s), and by what, in words."""
        rows = self._ask("SELECT moment_s, moment FROM trials WHERE id = ?", (trial_id,))
        if not rows:
            raise ValueError(self._unknown(trial_id))
        return rows[0][0], rows[0][1]

    def _unknown(self, trial_id: str, several: bool = False) -> str:
        ids = [row[0] for row in self._ask("SELECT id FROM trials ORDER BY id")]
        if not ids:
            return f"there is no trial {trial_id!r}: {self.path} is empty; run an experiment first"
        same = next((n for n in range(len(trial_id), 0, -1) if any(each.startswith(trial_id[:n]) for each in ids)), 0)
        close = ", ".join([each for each in ids if each.startswith(trial_id[:same])][:5])
        words = "several trials begin with" if several else "there is no trial"
        return f"{words} {trial_id!r} in {self.path}; expected an id, such as {close}"

    def _scores(self, ids: Sequence[str]) -> dict[str, dict[str, float]]:
        scores: dict[str, dict[str, float]] = {}
        for trial, name, value in self._asked("SELECT trial, name, value FROM scores WHERE trial IN", ids):
            scores.setdefault(trial, {})[name] = value
        return scores

    def _asked(self, question: str, ids: Sequence[str]) -> Generator[tuple[Any, ...]]:
        for start in range(0, len(ids), _AT_ONCE):
            some = ids[start : start + _AT_ONCE]
            yield from self._ask(f"{question} ({','.join('?' * len(some))})", some)

    def _ask(self, question: str, values: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
        try:
            return self._db.execute(question, values).fetchall()
        except sqlite3.DatabaseError as error:
            raise _broken(self.path, error) from None


def _stored(
    row: Sequence[Any], scores: dict[str, dict[str, float]], engine: str, levels: tuple[str, ...]
) -> StoredTrial:
    trial_id, _, _, seed, moment_s, words, simulated_s, wall_s, error, version, quick = row
    return StoredTrial(
        trial_id, engine, levels, seed, scores.get(trial_id, {}), moment_s, words, simulated_s, wall_s, error, version,
        bool(quick),
    )  # fmt: skip


def _definition_of(trial: Trial) -> str:
    """All of a trial but its seed, as JSON: the trials of a cell share it."""
    tree = {
        "experiment": trial.experiment,
        "engine": trial.engine,
        "levels": trial.levels,
        "world": trial.world,
        "world_text": trial.world_text,
        "values": trial.values,
        "protocol": _STEPS.dump_python(trial.protocol, mode="json"),
        "measures": trial.measures,
        "version": trial.version,
        "quick": trial.quick,
    }
    return json.dumps(tree, sort_keys=True, separators=(",", ":"))


def _trial_from(definition: str, seed: int) -> Trial:
    """The trial whose definition this is."""
    tree: dict[str, Any] = json.loads(definition)
    return Trial(
        tree["experiment"], tree["engine"], tuple(tree["levels"]), seed, tree["world"], tree["world_text"], tree["values"],
        _STEPS.validate_python(tree["protocol"]), tuple(tree["measures"]), tree["version"], tree["quick"],
    )  # fmt: skip


def _opened(path: Path) -> sqlite3.Connection:
    """A file that exists, to be read only and without waiting. ValueError if it cannot be, or is something else."""
    where = f"{path.absolute().as_uri()}?mode=ro"
    try:
        connection = sqlite3.connect(
            where, uri=True, timeout=READ_BUSY_S, isolation_level=None, check_same_thread=False
        )
    except sqlite3.Error as error:
        raise _broken(path, error) from None
    return _ready(connection, path, _require_ours)


def connected(path: Path) -> sqlite3.Connection:
    """The file, made if it does not exist. ValueError if it is something else, or of a newer program."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        way_out = "the trials need; keep them on a local disk: --store FILE, or RATSLAM_EXPERIMENTS"
        require_record_locks(path.parent, way_out)
        connection = sqlite3.connect(path, timeout=BUSY_S, isolation_level=None, check_same_thread=False)
    except (OSError, sqlite3.OperationalError) as error:
        raise ValueError(f"--store {path}: {getattr(error, 'strerror', None) or error}") from None
    return _ready(connection, path, _make_tables)


def _ready(
    connection: sqlite3.Connection, path: Path, prepare: Callable[[sqlite3.Connection, Path], None]
) -> sqlite3.Connection:
    """The connection, prepared; closed again if that fails."""
    try:
        prepare(connection, path)
    except (sqlite3.Error, ValueError) as error:
        connection.close()
        raise (_broken(path, error) if isinstance(error, sqlite3.Error) else error) from None
    return connection


def _make_tables(connection: sqlite3.Connection, path: Path) -> None:
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")  # a killed process loses nothing; a power cut the last moments
    connection.execute("PRAGMA foreign_keys = ON")
    connection.execute("BEGIN IMMEDIATE")  # two commands may begin at once
    found = connection.execute("PRAGMA user_version").fetchone()[0]
    empty = not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if found == 0 and empty:
        for statement in _TABLES.split(";\n"):
            connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {VERSION}")
    connection.execute("COMMIT")
    _require_ours(connection, path)


def _require_ours(connection: sqlite3.Connection, path: Path) -> None:
    found = connection.execute("PRAGMA user_version").fetchone()[0]
    if found == 0:
        raise ValueError(f"--store {path}: this is another program's database; name a new file")
    if found > VERSION:
        raise ValueError(
            f"--store {path}: its tables have version {found}, this program knows {VERSION}; use a newer program, or a new file"
        )


def _broken(path: Path, error: sqlite3.Error) -> ValueError:
    """What is wrong with the file, and the way out."""
    if "locked" in str(error) or "busy" in str(error):
        return ValueError(
            f"--store {path}: another program has locked it; end that one, or name another file by --store"
        )
    return ValueError(
        f"--store {path}: {error}; name a file that `ratslam experiment` has made, or a new one; or move this one away, and a "
        "new one is begun in its place"
    )


@dataclass(frozen=True, slots=True)
class OpenedTrial:
    """A trial, the moment that decided it (simulated s, words), and warnings: why the run may differ from the stored one."""

    trial: Trial
    moment_s: float
    moment_words: str
    warnings: tuple[str, ...]


def open_trial(trial_id: str, store: Store) -> OpenedTrial:
    """The trial with this id, or whose id alone begins so. ValueError if there is none, or its world has gone."""
    trial = store.trial(trial_id)
    moment_s, words = store.moment(trial.id)
    return OpenedTrial(trial, moment_s, words, tuple(_warnings(trial)))


def _warnings(trial: Trial) -> list[str]:
    warnings: list[str] = []
    if trial.version != code_version():
        warnings.append(
            f"the trial was run by version {trial.version} of the program, this is {code_version()}: the run may differ"
        )
    from sim2d.importers import open_world

    if text_of(open_world(trial.world)) != trial.world_text:
        warnings.append(f"the world {trial.world} has changed since the trial: the run may differ")
    return warnings

"""The tables of the file in which trials are kept."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from pathlib import Path

from disk.locks import require_record_locks

VERSION = 1  # of these tables, kept as the file's user_version
BUSY_S = 60.0  # how long a command that writes waits for another that does
READ_BUSY_S = 0.5  # and one that only reads: the file's journal lets it read meanwhile, unless somebody locks it whole

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


def broken(path: Path, error: sqlite3.Error) -> ValueError:
    """What is wrong with the file, and the way out."""
    if "locked" in str(error) or "busy" in str(error):
        return ValueError(
            f"--store {path}: another program has locked it; end that one, or name another file by --store"
        )
    return ValueError(
        f"--store {path}: {error}; name a file that `ratslam experiment` has made, or a new one; or move this one away, and a "
        "new one is begun in its place"
    )


def opened(path: Path) -> sqlite3.Connection:
    """A file that exists, to be read only and without waiting. ValueError if it cannot be, or is something else."""
    where = f"{path.absolute().as_uri()}?mode=ro"
    try:
        connection = sqlite3.connect(
            where, uri=True, timeout=READ_BUSY_S, isolation_level=None, check_same_thread=False
        )
    except sqlite3.Error as error:
        raise broken(path, error) from None
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
        raise (broken(path, error) if isinstance(error, sqlite3.Error) else error) from None
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

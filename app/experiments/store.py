"""Trials and their scores in one SQLite file. Trajectories are not kept: the same trial runs again, bit for bit."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import sqlite3
from collections.abc import Generator, Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from app.experiments.definition import definition_of, trial_from
from app.experiments.outcome import Outcome
from app.experiments.schema import broken, connected, opened
from app.experiments.stored_trial import StoredTrial
from app.trials.trial import Trial
from disk import kept_folder

_AT_ONCE = 500  # ids in one question
_COLUMNS = "id, engine, levels, seed, moment_s, moment, simulated_s, wall_s, error, version, quick"
# "OR IGNORE" would also pass over a row that lacks a value
_INSERT = f"INSERT INTO trials VALUES ({', '.join('?' * 16)}) ON CONFLICT (id) DO NOTHING"
_MADE_AGAIN = "SELECT text, seed FROM trials JOIN definitions ON digest = definition WHERE substr(id, 1, ?) = ? LIMIT 2"


def default_path() -> Path:
    """RATSLAM_EXPERIMENTS, or `.ratslam/experiments.sqlite` in the home directory. ValueError without a home."""
    return Path(os.environ.get("RATSLAM_EXPERIMENTS") or kept_folder() / "experiments.sqlite")


class Store:
    """One process writes; others may read and, when it is their turn, write as well."""

    def __init__(self, path: Path | None = None, *, reading: bool = False) -> None:
        """reading: nothing is added, and nobody waited for; the file must exist then. ValueError, here and from everything that
        is asked of it: the file cannot be made or read, or is something else."""
        self.path = path or default_path()
        self._db = opened(self.path) if reading else connected(self.path)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._db.close()

    # ------------------------------------------------------------ writing

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
        text = definition_of(trial)
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
                raise broken(self.path, error) from None
            raise

    # ------------------------------------------------------------ reading

    def _ask(self, question: str, values: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
        try:
            return self._db.execute(question, values).fetchall()
        except sqlite3.DatabaseError as error:
            raise broken(self.path, error) from None

    def done(self, ids: Iterable[str]) -> set[str]:
        """Which of these trials have scores."""
        return {row[0] for row in self._asked("SELECT id FROM trials WHERE error = '' AND id IN", list(ids))}

    def stored(self, trials: Sequence[Trial]) -> list[StoredTrial]:
        """Those of these trials that were run, in their order. One that two experiments or cells share counts in both."""
        ids = list({trial.id for trial in trials})
        rows = {row[0]: row for row in self._asked(f"SELECT {_COLUMNS} FROM trials WHERE id IN", ids)}
        scores = self._scores(list(rows))
        return [
            _stored(rows[trial.id], scores, trial.engine, trial.levels) for trial in trials if trial.id in rows
        ]  # fmt: skip

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
            return trial_from(*rows[0])
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


def _stored(
    row: Sequence[Any], scores: dict[str, dict[str, float]], engine: str, levels: tuple[str, ...]
) -> StoredTrial:
    trial_id, _, _, seed, moment_s, words, simulated_s, wall_s, error, version, quick = row
    return StoredTrial(
        trial_id, engine, levels, seed, scores.get(trial_id, {}), moment_s, words, simulated_s, wall_s, error, version,
        bool(quick),
    )  # fmt: skip

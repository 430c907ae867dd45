"""What is shown while trials run: a bar and the table that fills in on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import replace

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from app.experiments.pool import time_words
from app.experiments.store import Outcome, StoredTrial
from app.experiments.summary import CellKey, CellSummary, place_in, summarise, table_of
from app.protocol.experiment import Experiment
from app.protocol.trial import Trial

REDRAW_S = 0.5
LINE_EVERY_S = 15.0
_ROOM = 8  # lines of the terminal that the table leaves free


class LiveTable:
    """Use it in a `with` block, and `add` what has ended."""

    def __init__(
        self, experiment: Experiment, plan: Sequence[Trial], kept: Sequence[StoredTrial], expected_s: float
    ) -> None:
        """plan: all trials of the table; kept: those that are done already; expected_s: wall time of the rest."""
        self._experiment, self._expected_s = experiment, expected_s
        self._cells: dict[CellKey, list[StoredTrial]] = {}
        self._rows: dict[CellKey, CellSummary] = {}
        self._changed: dict[CellKey, None] = {}  # the order of change, last last
        self._places: dict[str, list[CellKey]] = {}  # cells that share a trial
        for trial in plan:
            self._places.setdefault(trial.id, []).append((trial.engine, trial.levels))
        good = [trial for trial in kept if not trial.error]
        for trial in good:
            self._put((trial.engine, trial.levels), trial)
        self._total, self._done, self._new, self._failed = len(self._places), len({trial.id for trial in good}), 0, 0
        self._began_s = self._line_s = time.monotonic()
        self._drawn_s = 0.0
        console = Console(stderr=True)
        self._height = max(3, console.height - _ROOM)
        self._bar = Progress(
            SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"), console=console,
        )  # fmt: skip
        self._task = self._bar.add_task(experiment.name, total=self._total, completed=self._done, left=self._left())
        self._live = Live(console=console, auto_refresh=True, transient=True) if sys.stderr.isatty() else None

    def __enter__(self) -> LiveTable:
        if self._live is not None:
            self._live.start()
            self._draw()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def add(self, ended: Sequence[tuple[Trial, Outcome]]) -> None:
        """These have ended and are kept."""
        for trial, outcome in ended:
            result = outcome.result
            self._new += 1
            if result is None:
                self._failed += 1
                continue
            self._done += 1
            deciding = result.deciding
            stored = StoredTrial(
                trial.id, trial.engine, trial.levels, trial.seed, result.scores, deciding.time_s, deciding.words
            )
            for engine, levels in self._places[trial.id]:
                self._put((engine, levels), replace(stored, engine=engine, levels=levels))
        self._show()

    def _put(self, key: CellKey, trial: StoredTrial) -> None:
        self._cells.setdefault(key, []).append(trial)
        self._rows.pop(key, None)
        self._changed.pop(key, None)
        self._changed[key] = None

    def _show(self) -> None:
        now_s = time.monotonic()
        if self._live is not None:
            if now_s - self._drawn_s > REDRAW_S:
                self._draw()
        elif now_s - self._line_s > LINE_EVERY_S:
            self._line_s = now_s
            failed = f", {self._failed} failed" if self._failed else ""
            name = self._experiment.name
            print(f"{name}: {self._done} of {self._total} trials{failed}; {self._left()}", file=sys.stderr, flush=True)

    def _draw(self) -> None:
        assert self._live is not None
        self._drawn_s = time.monotonic()
        self._bar.update(self._task, completed=self._done, left=self._left())
        shown = sorted(list(self._changed)[-self._height :], key=place_in(self._experiment))  # those that change
        table = table_of(self._experiment, [self._row(key) for key in shown])
        self._live.update(Group(self._bar, table))

    def _row(self, key: CellKey) -> CellSummary:
        if key not in self._rows:
            self._rows[key] = summarise(self._experiment, self._cells[key])[0]
        return self._rows[key]

    def _left(self) -> str:
        left = self._total - self._done - self._failed
        each_s = (time.monotonic() - self._began_s) / self._new if self._new else 0.0
        seconds = left * each_s if self._new else self._expected_s
        return f"about {time_words(seconds)} left" if left else "done"

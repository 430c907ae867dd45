"""The rows: which runs each is made of, and what is judged about them.

The seeds are such on which nothing was chosen; whoever develops takes others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

from app.config import Config, Value
from benchmarks.true_map import figures
from benchmarks.true_map.figures import Figure, Report
from benchmarks.true_map.jobs import Job

FIRST_SEED = 7001
HALLS = ("campus", "corridors", "floor", "two-goals")
WORLDS = ("office", "campus", "corridors", "floor", "living", "loop", "open-plan", "suburb", "twins", "two-goals")
PLANS: dict[str, tuple[str, float | None]] = {  # where they lie in the folder of the data, metres a pixel
    "AHG2": ("worlds/amrl/AHG2.vectormap.json", None),
    "NSH1": ("worlds/amrl/NSH1.vectormap.json", None),
    "3ne": ("worlds/gdc_3ne/3ne.yaml", None),
    "willow": ("worlds/willow/willow-full.pgm", 0.1),
}
STEADY: dict[str, Value] = {f"office.{name}": False for name in ("people", "doors", "daylight", "script")}
TIMES_4 = ("robot.odometry_noise", "robot.odometry_scale_error", "robot.gyro_bias")


Judge = Callable[[list[Report]], Iterator[Figure]]


@dataclass(frozen=True, slots=True)
class Options:
    """What can be asked for."""

    data: Path
    seeds: tuple[int, ...] = ()  # empty: as many as the row wants
    worlds: tuple[str, ...] = ()  # empty: all of the row
    deliveries: int = 1143
    values: dict[str, Value] = field(default_factory=dict[str, Value])


Jobs = Callable[[Options, tuple[int, ...]], list[Job]]


@dataclass(frozen=True, slots=True)
class Row:
    """One row of the table of bars."""

    name: str
    work: str
    seeds: int
    jobs: Jobs
    judge: Judge

    def planned(self, options: Options) -> list[Job]:
        """Its runs with these options."""
        seeds = options.seeds or tuple(range(FIRST_SEED, FIRST_SEED + self.seeds))
        jobs = [job for job in self.jobs(options, seeds) if job.name in options.worlds or not options.worlds]
        return [replace(job, values=options.values | job.values) for job in jobs]


def _explored(
    row: str,
    worlds: tuple[str, ...],
    minutes: float,
    goals: int = 5,
    variants: dict[str, dict[str, Value]] | None = None,
) -> Jobs:
    """Exploring and then goals, in each world with each seed and variant."""

    def jobs(_options: Options, seeds: tuple[int, ...]) -> list[Job]:
        return [
            Job(row=row, world=w, name=w, seed=s, minutes=minutes, goals=goals, variant=name, values=values)
            for w in worlds
            for s in seeds
            for name, values in (variants or {"": {}}).items()
        ]

    return jobs


def _times_4() -> dict[str, Value]:
    defaults = {dotted: value for dotted, _, value in Config().items()}
    return {name: 4 * defaults[name] for name in TIMES_4}


def _plans(options: Options, seeds: tuple[int, ...]) -> list[Job]:
    there = {n: (options.data / file, scale) for n, (file, scale) in PLANS.items() if (options.data / file).is_file()}
    return [
        Job(row="plans", world=str(file), scale_m=scale, name=name, seed=seed, minutes=60.0, goals=5)
        for name, (file, scale) in there.items()
        for seed in seeds
    ]


def _kidnaps(_options: Options, seeds: tuple[int, ...]) -> list[Job]:
    """Ten in each world, in runs of two or three, so that each robot has time to find itself; and the runs without."""
    each = [10 // len(seeds) + (k < 10 % len(seeds)) for k in range(len(seeds))]
    return [
        Job(
            row="kidnaps",
            world=w,
            name=w,
            seed=s,
            minutes=30.0,
            kidnaps=n * carried,
            variant="" if carried else "without",
        )
        for w in WORLDS
        for s, n in zip(seeds, each, strict=True)
        for carried in (True, False)
    ]


def _deliveries(options: Options, seeds: tuple[int, ...]) -> list[Job]:
    count = options.deliveries
    return [
        Job(row="deliveries", world="living", name="living", seed=s, minutes=20.0, goals=11, deliveries=count)
        for s in seeds
    ]


def _judge_living(runs: list[Report]) -> Iterator[Figure]:
    on, off = _apart(runs, "off")
    yield from figures.map_errors(on, 0.35, 0.5)
    yield from figures.goals(on, 0.96, "48 of 50")
    yield figures.revisits(on, off)


def _judge_halls(runs: list[Report]) -> Iterator[Figure]:
    yield from figures.map_errors(runs, 0.35, 0.6)
    yield from figures.goals(runs, 0.95, "95 of 100")
    corridors = [run for run in runs if run["name"] == "corridors"]
    if corridors:
        yield replace(figures.loops(corridors), what="corridors: loop closed")


def _judge_kidnaps(runs: list[Report]) -> Iterator[Figure]:
    yield from figures.kidnaps(*_apart(runs, "without"))


def _judge_suburb(runs: list[Report]) -> Iterator[Figure]:
    yield figures.loops(runs)
    yield from figures.map_errors(runs, None, 2.0)
    yield figures.at_least(
        "speed", min((r.get("real_time_factor", 0.0) for r in runs), default=0.0), 200, "x real time"
    )


def _apart(runs: list[Report], variant: str) -> tuple[list[Report], list[Report]]:
    return [run for run in runs if run["variant"] != variant], [run for run in runs if run["variant"] == variant]


def _maps(
    median: float | None, worst: float, least: float | None = None, words: str = "", miss: float | None = None
) -> Judge:
    """least: the share of the goals that has to be reached, as `words` say it. miss: the bar of their median miss."""

    def judge(runs: list[Report]) -> Iterator[Figure]:
        asked = figures.goals(runs, least, words, miss) if least is not None else iter(())
        return chain(figures.map_errors(runs, median, worst), asked)

    return judge


ROWS: dict[str, Row] = {
    row.name: row
    for row in (
        Row("office", "20 min and 5 goals", 10, _explored("office", ("office",), 20), _maps(0.15, 0.22, 1.0, "50 of 50", 0.2)),
        Row("twins", "30 min and 5 goals", 10, _explored("twins", ("twins",), 30), _maps(0.3, 0.6, 0.96, "48 of 50")),
        Row("living", "20 min and 5 goals, everything on, and beside it off", 10,
            _explored("living", ("living",), 20, variants={"": {}, "off": STEADY}), _judge_living),
        Row("halls", "campus, corridors, floor, two-goals: 30 min and 5 goals", 5, _explored("halls", HALLS, 30), _judge_halls),
        Row("plans", "real floor plans: 60 min and 5 goals", 3, _plans, _maps(0.5, 1.0, 0.9, "9 of 10")),
        Row("suburb", "5 h", 1, _explored("suburb", ("suburb",), 300, goals=0), _judge_suburb),
        Row("kidnaps", "ten kidnaps in each of ten worlds, and the same without", 4, _kidnaps, _judge_kidnaps),
        Row("wheels", "office, 20 min, all errors of the wheels times 4", 5,
            _explored("wheels", ("office",), 20, goals=0, variants={"": _times_4()}), _maps(None, 0.5)),
        Row("deliveries", "living office, 11 goals", 1, _deliveries, figures.deliveries),
        Row("long", "office, 10 h: speed and growth", 1, _explored("long", ("office",), 600, goals=0), figures.speeds),
    )
}  # fmt: skip

"""A small experiment with trials and traces that were never run, so that figures and pages can be tested in no time."""

from __future__ import annotations

import math

import numpy as np

from app.experiments.figures.material import Material
from app.experiments.store import StoredTrial
from app.protocol.course import Moment, Visited
from app.protocol.experiment import Axis, EngineSpec, Experiment, FigureSpec, Level, Original, Score
from app.protocol.steps import Explore
from app.protocol.trace import Carried, FinalMap, Goal, Grid, Movements, Plan, Trace
from app.protocol.trial import Trial
from ratslam_core import Pose2

SIZES, RATES = ("8", "16"), ("0 %", "2 %", "10 %")


def experiment(**changes: object) -> Experiment:
    """Two axes, two engines, a rate and a number. changes: fields that differ."""
    made = Experiment(
        name="made",
        title="Made <up> & never run",
        paper="D 6, figure 9",
        asks="Does <b>this</b> work?",
        found='It "does".',
        trials=4,
        seed=10,
        engines={"paper": EngineSpec(preset="paper-2006"), "ours": EngineSpec()},
        axes=[
            Axis(name="N_vis", levels=[Level(label=label) for label in RATES]),
            Axis(name="size", levels=[Level(label=label) for label in SIZES]),
        ],
        protocol=[Explore(do="explore", minutes=1)],
        scores=[
            Score(label="goals reached", rate=("reached", "goals")),
            Score(label="map error", score="error_m", unit="m"),
            Score(label="recovered", rate=("recovered", "kidnaps")),
            Score(label="after", score="kidnap_1_s", unit="s"),
            Score(label="after a way of", score="kidnap_1_m", unit="m"),
        ],
        original=[Original(score="goals reached", levels=["0 %", "8"], value=0.81, source="D figure 9")],
    )
    return made.model_copy(update=changes)


def trials(of: Experiment) -> list[StoredTrial]:
    """All its trials with scores drawn by chance; each has an id of its own."""
    rng = np.random.default_rng(5)
    cells = [tuple(level.label for level in cell) for cell in of.cells()]
    made: list[StoredTrial] = []
    for seed in range(of.seed, of.seed + of.trials):
        for engine in of.engines:
            for levels in cells:
                scores = {"goals": 3.0, "reached": float(rng.integers(0, 4)), "error_m": float(rng.uniform(0.1, 2.0))}
                recovered = rng.random() < 0.7
                scores |= {"kidnaps": 1.0, "recovered": float(recovered)}
                if recovered:
                    scores |= {"kidnap_1_s": float(rng.uniform(1, 60)), "kidnap_1_m": float(rng.uniform(1, 20))}
                made.append(
                    StoredTrial(
                        f"{len(made):016x}", engine, levels, seed, scores, 61.5, "kitchen: reached", 90.0, 1.0, "", "v1"
                    )
                )
    return made


def trace(stored: StoredTrial, of: Experiment) -> Trace:
    """A robot that drove round in a circle, was kidnapped once, and snapped twice."""
    rng = np.random.default_rng(stored.seed)
    n = 120
    time = np.arange(n) * 0.5
    angle = 2 * math.pi * np.arange(n) / 40
    truth = np.column_stack([5 + 2 * np.cos(angle), 4 + 2 * np.sin(angle), angle])
    cells = np.column_stack([(8 * angle / math.pi) % 16, np.full(n, 3.0), angle % (2 * math.pi)])
    mass = np.column_stack([np.full(n, 0.8), np.where(time > 20, 0.2, 0.0), np.zeros(n), np.zeros(n)])
    count = 20
    made_at = np.linspace(0, n - 1, count).astype(int)
    poses = truth[made_at] + rng.normal(0, 0.05, (count, 3))
    ahead = np.arange(count - 1)
    trial = Trial(of.name, stored.engine, stored.levels, stored.seed, "office", "", {}, tuple(of.protocol), (), "v1")
    object.__setattr__(trial, "id", stored.id)
    times, lead = loop_times()
    picture = FinalMap(
        in_office=Pose2(1.0, 1.0, 0.1),
        poses=poses,
        truth=truth[made_at],
        states=np.zeros((count, 3)),
        views=np.arange(count),
        links=np.column_stack([ahead, ahead + 1]),
        goal=3,
        times_s=np.abs(np.arange(count) - 3.0),
        multiple=((0, 13),),
        collisions=((2, 9), (4, 11, 17)),
        occupancy=Grid(rng.uniform(0, 1, (6, 8)), (0.0, 0.0), 0.5),
        cells_occupancy=Grid(rng.uniform(0, 1, (16, 16)), (0.0, 0.0), 1.0),
        goal_times=Grid(times, (0.0, 0.0), 1.0),
        goal_lead=Grid(lead, (0.0, 0.0), 1.0),
    )
    walls = np.array([[0.0, 0, 10, 0], [10, 0, 10, 8], [10, 8, 0, 8], [0, 8, 0, 0]])
    return Trace(
        trial=trial, time_s=time, truth=truth, cells=cells, mass=mass, off_m=np.abs(rng.normal(0, 0.1, n)),
        residual=np.full(n, 0.02), views=np.arange(n), experiences=np.arange(n) // 6, active=np.arange(n) // 6,
        snaps=np.array([[10.25, 1, 2, 0, 9, 9, 1], [30.25, 9, 9, 0, 1, 2, 1]], float),
        error_time_s=np.array([0.0, 15, 30, 45]), error_m=np.array([0.0, 0.2, 0.1, 0.1]),
        true_path=truth[:, :2], mapped_path=truth[:, :2] + 0.1, odometry_path=truth[:, :2] * 1.2,
        cells_shape=(36, 16, 16), cell_m=0.25, map=picture,
        plan=Plan("office", walls, (np.array([[1.0, 1], [2, 1], [2, 2], [1, 2]]),), (0.0, 0.0, 10.0, 8.0)),
        moments=(Moment(20.0, "kidnapped"), Moment(33.0, "recovered 13.0 s and 4.0 m after the kidnap", True),
                 Moment(59.5, "the end")),
        goals=(Goal("kitchen", 7.0, 4.0, 3), Goal("printer", 1.0, 7.0, None)),
        visits=(Visited("kitchen", 3, True, 40.0, 10.0, 3.0, 2.5, 0.1, ""),
                Visited("printer", 5, False, 50.0, 9.0, 1.0, 4.0, 5.0, "no")),
        kidnaps=(Carried(20.0, 13.0, 4.0),), movements=movements(),
    )  # fmt: skip


def loop_times() -> tuple[np.ndarray, np.ndarray]:
    """Times to a goal (s) and leads (s), (16, 16), on a wide ring about (8, 8); the goal is at (13, 8), 20 s from opposite."""
    y, x = np.mgrid[:16, :16]
    ring = np.abs(np.hypot(x - 8, y - 8) - 5) < 2.1
    share = np.abs(np.arctan2(y - 8, x - 8)) / math.pi
    return np.where(ring, 20 * share, np.inf), np.where(ring, 40 * (1 - share), np.inf)


def movements() -> Movements:
    """Three arcs that lead on and one turn on the spot: the first is barred, the second chosen."""
    ahead = np.linspace(0, 0.4, 9)[:, None]
    ways = [np.array([5.0, 4.0]) + ahead * np.array([math.cos(a), math.sin(a)]) for a in (0.5, 0.0, -0.5)]
    return Movements(
        time_s=30.0, robot=Pose2(5.0, 4.0, 0.0), radius_m=0.2, paths=np.array([*ways, np.full((9, 2), [5.0, 4.0])]),
        cost=np.array([np.inf, 0.2, 0.5, 0.9]), drives=np.array([True, True, True, False]), chosen=1,
        aim=np.array([5.8, 4.1]), route=np.array([[5.0, 4.1], [5.5, 4.1], [6.0, 4.2]]),
    )  # fmt: skip


def material(of: Experiment | None = None, *, traced: bool = False) -> Material:
    """Everything that figures are made of. traced: every trial has a trace."""
    of = of or experiment()
    stored = trials(of)
    return Material(of, stored, {each.id: trace(each, of) for each in stored} if traced else {})


def figure(kind: str, **options: object) -> FigureSpec:
    return FigureSpec(kind=kind, title=f"A figure of {kind}", options=options)

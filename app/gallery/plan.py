"""The plan of an experiment's world, with the way that its protocol drives: what stands for a figure that is not there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from app.trials.checking import place_of
from app.trials.experiment import Experiment
from app.trials.steps import Drive, Repeat, Step, Tag
from sim2d import World
from web.http.experiments import Plan

MARGIN_M = 0.3


def plan_of(experiment: Experiment, world: World) -> Plan:
    ends = [(wall.x1, wall.y1, wall.x2, wall.y2) for wall in world.walls]
    xs = [x for x1, _, x2, _ in ends for x in (x1, x2)]
    ys = [y for _, y1, _, y2 in ends for y in (y1, y2)]
    left, bottom = min(xs) - MARGIN_M, min(ys) - MARGIN_M
    steps = list(_flat(experiment.protocol))
    drives = [[place_of(world, where) for where in step.path] for step in steps if isinstance(step, Drive)]
    tagged = [place_of(world, name) for step in steps if isinstance(step, Tag) for name in step.places]
    return Plan(
        width=round(max(xs) + MARGIN_M - left, 2),
        depth=round(max(ys) + MARGIN_M - bottom, 2),
        left=round(left, 2),
        bottom=round(bottom, 2),
        walls="".join(f"M{x1:.2f} {y1:.2f}L{x2:.2f} {y2:.2f}" for x1, y1, x2, y2 in ends),
        way="".join(map(_line, drives)),
        places=tagged,
    )


def _flat(steps: Sequence[Step]) -> Iterable[Step]:
    for step in steps:
        if isinstance(step, Repeat):
            yield from _flat(step.steps)
        else:
            yield step


def _line(points: list[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in points)

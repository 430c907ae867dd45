"""Whether the steps of a protocol fit the world and the parameters, before the first of them is carried out."""

from __future__ import annotations

from collections.abc import Sequence

from app.session import Session
from app.trials.steps import Door, Drive, Kidnap, Repeat, Send, Set, Step, Tag, TagHere, Visit, Where
from sim2d import World


def place_of(world: World, where: Where) -> tuple[float, float]:
    """A place of the world by name, or the point itself (m, office frame). ValueError lists the names."""
    if not isinstance(where, str):
        return where
    known = [*world.places, *world.starts]
    for place in known:
        if place.name == where:
            return place.x, place.y
    names = ", ".join(place.name for place in known)
    raise ValueError(f"{world.name} has no place {where!r}; expected one of: {names}, or [x, y] in metres")


def check_steps(session: Session, steps: Sequence[Step], tagged: frozenset[str] = frozenset()) -> None:
    """ValueError names a place, door or parameter that does not exist, or a goal that nothing has tagged."""
    for step in steps:
        if isinstance(step, Repeat):
            check_steps(session, step.steps, tagged)
        elif isinstance(step, Tag):
            tagged |= set(step.places)
        elif isinstance(step, TagHere):
            tagged |= {step.name}
        elif isinstance(step, Set):
            session.config.with_values(step.values)
        elif isinstance(step, Door):
            _check_door(session.world, step.name)
        for where in _places(step):
            place_of(session.world, where)
        goals = step.places if isinstance(step, Visit) else [step.place] if isinstance(step, Send) else []
        missing = [name for name in goals if name not in tagged]
        if missing:
            raise ValueError(f"{step.do} {missing[0]!r}: nothing is tagged so before; tag it first")


def _places(step: Step) -> Sequence[Where]:
    match step:
        case Tag(places=places):
            return places
        case Drive(path=path):
            return path
        case Kidnap(place=place) if place is not None:
            return [place]
        case _:
            return []


def _check_door(world: World, name: str) -> None:
    names = [door.name for door in world.doors]
    if name not in names:
        raise ValueError(f"no door {name!r} in {world.name}; expected one of: {', '.join(names) or 'there are none'}")

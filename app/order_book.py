"""What a session was told between two ticks, as data: with the seed and the world, it makes the run again, bit for bit."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol, TypeVar, cast

from sim2d import Box, World, world_from_json, world_to_json

UNCHANGED = object()  # what a method of Session returns when the order was in force already
_SETTING = frozenset(("cancel_goal", "set_mode", "set_door", "set_lamp", "tag"))  # given twice, they do what one does
Method = TypeVar("Method", bound=Callable[..., object])


@dataclass(frozen=True, slots=True)
class Order:
    """One order, which was carried out after this tick and before the next.

    name: of a method of Session; values: its arguments as JSON (a world: the text of its file; a box: its fields).
    """

    tick: int
    name: str
    values: dict[str, Any]


def overtakes(later: Order, before: Order) -> bool:
    """Whether the later of two orders, with none between them, does alone what both do: who keeps orders keeps that one."""
    if later.tick != before.tick or later.name != before.name:
        return False
    return later.name == "drive" or (later.name in _SETTING and later.values == before.values)


class Ordered(Protocol):
    """Who has orders: tells `on_order` of each that was carried out."""

    on_order: Callable[[Order], object]
    under_orders: bool

    @property
    def tick_count(self) -> int: ...


def order(method: Method) -> Method:
    """A method of Session that is an order: once it is carried out, `session.on_order` is told. One that is refused, or that
    changes nothing, is none."""
    told_as = inspect.signature(method)

    @functools.wraps(method)
    def carried_out(self: Ordered, *args: object, **kwargs: object) -> object:
        if self.under_orders:  # a part of another order
            return method(self, *args, **kwargs)
        self.under_orders = True
        try:
            answer = method(self, *args, **kwargs)
        finally:
            self.under_orders = False
        if answer is UNCHANGED:
            return None
        _, *values = told_as.bind(self, *args, **kwargs).arguments.items()
        self.on_order(Order(self.tick_count, method.__name__, {name: _as_json(value) for name, value in values}))
        return answer

    carried_out.is_order = True  # type: ignore[attr-defined]
    return cast(Method, carried_out)


def carry_out(session: Ordered, order: Order) -> None:
    """Carry out an order again. ValueError says why it cannot be."""
    method = getattr(type(session), order.name, None)
    if not getattr(method, "is_order", False):
        raise ValueError(f"{order.name!r} is no order that a session can be given")
    values = dict(order.values)
    try:
        if "world" in values:
            values["world"] = world_from_json(values["world"], "the edited world", SMALLEST_M, begins=False)
        if "box" in values:
            box = values["box"]
            values["box"] = replace(Box(**box), colour=tuple(box["colour"]))
        getattr(session, order.name)(**values)
    except (TypeError, KeyError) as error:
        raise ValueError(f"{order.name}: {error}") from None


SMALLEST_M = 0.05  # radius of the smallest robot, for which a world is checked: its radius can be changed


def _as_json(value: object) -> object:
    if isinstance(value, World):
        return world_to_json(value)
    return asdict(value) if isinstance(value, Box) else value

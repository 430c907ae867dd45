"""The orders given to a session between two ticks, as data: with the seed and the world, it makes the run again, bit for bit."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Annotated, Any, Protocol, TypeVar, cast, get_type_hints

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, create_model

from sim2d import Box, World, world_from_json, world_to_json
from web.messages.commands import Name

UNCHANGED = object()  # what a method of Session returns when the order was in force already
_SETTING = frozenset(("cancel_goal", "set_mode", "set_door", "set_lamp", "tag"))  # given twice, they do what one does
Method = TypeVar("Method", bound=Callable[..., object])
METHODS: dict[str, Callable[..., object]] = {}  # of Session that are orders, by name


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
    """What orders act on; `on_order` is called with each that was carried out."""

    on_order: Callable[[Order], object]
    under_orders: bool

    @property
    def tick_count(self) -> int: ...


def order(method: Method) -> Method:
    """A method of Session that is an order: once it is carried out, `session.on_order` is called. One that is refused, or that
    changes nothing, is none."""
    signature = inspect.signature(method)

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
        _, *values = signature.bind(self, *args, **kwargs).arguments.items()
        self.on_order(Order(self.tick_count, method.__name__, {name: _as_json(value) for name, value in values}))
        return answer

    METHODS[method.__name__] = carried_out
    return cast(Method, carried_out)


def _as_json(value: object) -> object:
    if isinstance(value, World):
        return world_to_json(value)
    return asdict(value) if isinstance(value, Box) else value


SMALLEST_M = 0.05  # radius of the smallest robot, for which a world is checked: its radius can be changed


def carry_out(session: Ordered, order: Order) -> None:
    """Carry out an order again. ValueError says why it cannot be."""
    method = _method(order)
    values = dict(order.values)
    try:
        if "world" in values:
            values["world"] = world_from_json(values["world"], "the edited world", SMALLEST_M, begins=False)
        if "box" in values:
            box = values["box"]
            values["box"] = replace(Box(**box), colour=tuple(box["colour"]))
        method(session, **values)
    except (TypeError, KeyError) as error:
        raise ValueError(f"{order.name}: {error}") from None


def _method(order: Order) -> Callable[..., object]:
    if order.name not in METHODS:
        raise ValueError(f"{order.name[:40]!r} is no order that a session can be given")
    return METHODS[order.name]


# ------------------------------------------------------------ from a file or a link

_STRICT = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
_Size = Annotated[float, Field(ge=0.05, le=20.0)]  # as of the page's boxes
_Byte = Annotated[int, Field(ge=0, le=255)]
LARGEST = 1e9  # no number of an order, be it a place, a speed or a parameter, comes near it


class _Box(BaseModel):
    model_config = _STRICT
    name: Name
    x: float
    y: float
    width: _Size
    depth: _Size
    height: _Size
    angle_rad: float
    colour: Annotated[list[_Byte], Field(min_length=3, max_length=3)]
    present: bool


_AS_JSON: dict[Any, Any] = {World: str, Box: _Box, int: Annotated[int, Field(ge=0)]}  # as `order` writes them
_NARROWER: dict[
    tuple[str, str], Any
] = {  # where a session itself allows more; an experiment may drive faster than a page
    ("drive", "speed"): Annotated[float, Field(ge=-10, le=10)],
    ("drive", "yaw_rate"): Annotated[float, Field(ge=-20, le=20)],
    ("put_packet", "share"): Annotated[float, Field(ge=0.01, le=0.95)],
    ("tag", "name"): Name,
}


def check_order(order: Order) -> None:
    """ValueError: it is none that a session can be given, or its values are not of the right kinds."""
    _method(order)
    try:
        _values_of(order.name).validate_python(order.values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        wrong = first["msg"][0].lower() + first["msg"][1:]
        raise ValueError(f"{order.name}: {'.'.join(map(str, first['loc']))}: {wrong}") from None
    for name, value in order.values.items():
        if isinstance(value, float | int) and not abs(value) <= LARGEST:
            raise ValueError(f"{order.name}: {name}: it must be at most {LARGEST:g}, got {str(value)[:40]}")


@functools.cache
def _values_of(name: str) -> TypeAdapter[Any]:
    method = inspect.unwrap(METHODS[name])
    kinds = get_type_hints(method, globalns=method.__globals__)
    fields: dict[str, Any] = {}
    for key, parameter in list(inspect.signature(method).parameters.items())[1:]:
        default = ... if parameter.default is inspect.Parameter.empty else parameter.default
        kind = _AS_JSON.get(kinds[key], kinds[key])
        fields[key] = (_NARROWER.get((name, key), kind), default)
    return TypeAdapter(create_model(name, __config__=_STRICT, **fields))

"""An order that comes from a file or a link: is it one that a session can be given, with values of the right kinds?"""

from __future__ import annotations

import inspect
from functools import cache
from typing import Annotated, Any, get_type_hints

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, create_model

from app.order_book import Order
from app.session import Session
from sim2d import Box, World
from web.messages.commands import Name

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


_AS_JSON: dict[Any, Any] = {World: str, Box: _Box, int: Annotated[int, Field(ge=0)]}  # how the order book writes them
_NARROWER: dict[
    tuple[str, str], Any
] = {  # where a session itself allows more; an experiment may drive faster than a page
    ("drive", "speed"): Annotated[float, Field(ge=-10, le=10)],
    ("drive", "yaw_rate"): Annotated[float, Field(ge=-20, le=20)],
    ("put_packet", "share"): Annotated[float, Field(ge=0.01, le=0.95)],
    ("tag", "name"): Name,
}


def check_order(order: Order) -> None:
    """ValueError says what is wrong with it."""
    method = getattr(Session, order.name, None)
    if not getattr(method, "is_order", False):
        raise ValueError(f"{order.name[:40]!r} is no order that a session can be given")
    try:
        _values_of(order.name).validate_python(order.values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        wrong = first["msg"][0].lower() + first["msg"][1:]
        raise ValueError(f"{order.name}: {'.'.join(map(str, first['loc']))}: {wrong}") from None
    for name, value in order.values.items():
        if isinstance(value, float | int) and not abs(value) <= LARGEST:
            raise ValueError(f"{order.name}: {name}: it must be at most {LARGEST:g}, got {str(value)[:40]}")


@cache
def _values_of(name: str) -> TypeAdapter[Any]:
    method = inspect.unwrap(getattr(Session, name))
    kinds = get_type_hints(method, globalns=method.__globals__)
    fields: dict[str, Any] = {}
    for key, parameter in list(inspect.signature(method).parameters.items())[1:]:
        default = ... if parameter.default is inspect.Parameter.empty else parameter.default
        kind = _AS_JSON.get(kinds[key], kinds[key])
        fields[key] = (_NARROWER.get((name, key), kind), default)
    return TypeAdapter(create_model(name, __config__=_STRICT, **fields))

"""Whether an order in a file has the values that its method takes. Whoever can write a file can sign it, too."""

from __future__ import annotations

import inspect
import json
from functools import cache
from typing import Any, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from app import orders
from app.order_book import Order
from app.session import Session
from sim2d import Box, World

_STRICT = ConfigDict(strict=True, allow_inf_nan=False)
LARGEST = 1e9  # no number of an order, be it a place, a speed or a parameter, comes near it


def check_order(order: Order) -> None:
    """ValueError says what is wrong with its name or its values."""
    method = getattr(Session, order.name, None)
    if not getattr(method, "is_order", False):
        raise ValueError(f"{order.name[:40]!r} is no order that a session can be given")
    rules, needed = _rules(order.name)
    odd = sorted(order.values.keys() - rules.keys())
    lacks = sorted(needed - order.values.keys())
    if odd or lacks:
        raise ValueError(f"the order {order.name} {f'lacks {lacks[0]}' if lacks else f'has no value {odd[0][:40]!r}'}")
    for name, value in order.values.items():
        try:
            checked = rules[name].validate_json(json.dumps(value))
        except (ValidationError, ValueError) as error:
            words = error.errors()[0]["msg"] if isinstance(error, ValidationError) else str(error)
            raise ValueError(f"the order {order.name}: {name} is wrong: {words[:200]}") from None
        if isinstance(checked, float | int) and not abs(checked) <= LARGEST:
            raise ValueError(f"the order {order.name}: {name} must be at most {LARGEST:g}, got {str(value)[:40]}")


@cache
def _rules(name: str) -> tuple[dict[str, TypeAdapter[Any]], set[str]]:
    """What each value of an order must be, and which must not be missing. A world is the text of its file."""
    method = inspect.unwrap(getattr(Session, name))
    hints = get_type_hints(method, dict(vars(orders)))
    parameters = [each for each in inspect.signature(method).parameters.values() if each.name != "self"]
    kinds = {each.name: str if hints[each.name] is World else hints[each.name] for each in parameters}
    return (
        {name: TypeAdapter(kind) if kind is Box else TypeAdapter(kind, config=_STRICT) for name, kind in kinds.items()},
        {each.name for each in parameters if each.default is each.empty},
    )

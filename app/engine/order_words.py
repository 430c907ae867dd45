"""What the timeline says of an order that is given again."""

from __future__ import annotations

from app.order_book import Order
from app.session import Session
from app.views.goal_view import goal_view
from web.messages import EventKind

_OFFICE = {
    "set_door": "door {name} told to move", "set_lamp": "lamp {name} switched", "put_box": "a box put down",
    "remove_box": "box {name} taken away", "edit_world": "edited",
}  # fmt: skip


def events_of(order: Order, session: Session) -> list[tuple[EventKind, str]]:
    """Kinds and words; none for an order that is seen anyway. The session has just carried it out."""
    name, values = order.name, order.values
    if name == "kidnap":
        return [("kidnap", "carried away without being told")]
    if name in ("set_goal", "go_to_place_of", "go_to", "go_to_tag"):
        goal = goal_view(session)
        return [] if goal is None else [("goal", f"to experience {goal.experience}")]
    if name == "tag":
        return [("place", f"{values['name']} is here")]
    if name == "set_parameters":
        return [("parameter", f"{parameter} = {value}") for parameter, value in values["values"].items()]
    if name == "put_packet":
        return [("packet", f"a packet put at cell ({values['x']}, {values['y']}) by hand")]
    return [("office", _OFFICE[name].format_map(values))] if name in _OFFICE else []

"""What a person does to the office: doors, lamps, boxes, and another robot out of the box of presets."""

from __future__ import annotations

from app.presets import values_of
from app.session import Session
from sim2d import Box
from web import messages as m


def carry_out(session: Session, order: m.OfficeOrder) -> str:
    """Do it and say so in a few words. ValueError says why it cannot be."""
    simulator = session.simulator
    match order:
        case m.SetDoor(name=name, open=is_open):
            simulator.set_door(name, is_open)
            return f"{name} {'opens' if is_open else 'shuts'}"
        case m.SetLamp(name=name, on=on):
            simulator.set_lamp(name, on)
            return f"{name} {'on' if on else 'off'}"
        case m.PutBox():
            box = Box(order.name, order.x, order.y, order.width, order.depth, order.height, order.angle_rad)
            simulator.put_box(box)
            return f"{box.name} put down"
        case m.RemoveBox(name=name):
            simulator.remove_box(name)
            return f"{name} taken away"
        case m.UsePreset(name=name):
            waiting = session.set_parameters(values_of(name))
            return f"preset {name}" + (f"; from the next reset on: {', '.join(waiting)}" if waiting else "")

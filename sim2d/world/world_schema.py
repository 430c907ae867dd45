"""World files (format 1): their keys, types and limits, how the items become a World, and a World the text of a file."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from disk.words import lines, one_line
from sim2d.world.texture import Texture
from sim2d.world.world import (
    Action,
    Box,
    Daylight,
    Door,
    Event,
    Lamp,
    Panel,
    Person,
    Place,
    Rgb,
    SlowZone,
    Start,
    Wall,
    World,
)

Element = Wall | Start | Place | Door | Lamp | Box | Person | SlowZone | Event | Daylight
MOST_WALLS, MOST_PEOPLE, MOST_THINGS, MOST_EVENTS = 10_000, 50, 200, 1000
MOST = {"walls": MOST_WALLS, "people": MOST_PEOPLE, "script": MOST_EVENTS, "daylight": 1, **dict.fromkeys(
    ("starts", "places", "doors", "lamps", "boxes", "slow_zones"), MOST_THINGS
)}  # fmt: skip
_Kind = Literal["wall", "partition", "desk", "door", "window", "screen", "glass"]


class _Item(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


_Number = Annotated[float, Field(ge=-10_000, le=10_000)]
_Length = Annotated[float, Field(gt=0, le=10_000)]
_Height = Annotated[float, Field(gt=0, le=20)]
_Size = Annotated[float, Field(ge=0.05, le=20)]
_Seconds = Annotated[float, Field(ge=0, le=1e6)]
_Level = Annotated[float, Field(ge=0, le=3)]
_Degrees = Annotated[float, Field(ge=-360, le=360)]
_Point = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Colour = Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]
_Name = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(one_line)]
_NameOrNone = Annotated[str, Field(max_length=40), AfterValidator(one_line)]


class _PanelItem(_Item):
    at: Annotated[float, Field(ge=0, le=10_000)]
    width: _Length
    bottom: Annotated[float, Field(ge=0, le=20)]
    top: _Height
    texture: Texture
    colour: _Colour
    seed: Annotated[int, Field(ge=0)] = 0
    side: Literal["left", "right", "both"] = "left"


class _WallItem(_Item):
    start: Annotated[_Point, Field(alias="from")]
    end: Annotated[_Point, Field(alias="to")]
    kind: _Kind = "wall"
    height: _Height
    colour: _Colour
    outer: bool = False
    bottom: Annotated[float, Field(ge=0, le=20)] = 0.0
    panels: Annotated[list[_PanelItem], Field(max_length=2000)] = []
    name: _NameOrNone = ""
    reflection: Annotated[float, Field(ge=0, le=1)] = 0.25


class _StartItem(_Item):
    name: _Name
    x: _Number
    y: _Number
    heading_deg: _Degrees


class _PlaceItem(_Item):
    name: _Name
    x: _Number
    y: _Number


class _DoorItem(_Item):
    name: _Name
    hinge: _Point
    angle_deg: _Degrees
    width: Annotated[float, Field(ge=0.3, le=6)]
    height: _Height = 2.05
    colour: _Colour = "#8A5A33"
    swing_deg: Annotated[float, Field(ge=-175, le=175)] = 90.0
    slides: bool = False
    open: bool = True
    period_s: _Seconds = 0.0
    open_s: _Seconds = 0.0
    phase_s: _Seconds = 0.0


class _LampItem(_Item):
    name: _Name
    x: _Number
    y: _Number
    reach: Annotated[float, Field(ge=0.5, le=50)] = 4.0
    brightness: _Level = 0.5
    on: bool = True


class _DaylightItem(_Item):
    points: Annotated[
        list[Annotated[list[float], Field(min_length=2, max_length=2)]], Field(min_length=1, max_length=100)
    ]
    repeat_s: _Seconds = 0.0


class _BoxItem(_Item):
    name: _Name
    x: _Number
    y: _Number
    width: _Size
    depth: _Size
    height: _Height = 0.6
    angle_deg: _Degrees = 0.0
    colour: _Colour = "#B08956"
    present: bool = True


class _PersonItem(_Item):
    name: _Name
    path: Annotated[list[_Point], Field(min_length=1, max_length=100)]
    speed: Annotated[float, Field(ge=0.05, le=2)] = 0.8
    wait_s: Annotated[list[_Seconds], Field(min_length=1, max_length=100)] = [2.0]
    loop: bool = True
    radius: Annotated[float, Field(ge=0.1, le=0.5)] = 0.22
    height: Annotated[float, Field(ge=0.5, le=2.5)] = 1.7
    colour: _Colour = "#566E96"


class _ZoneItem(_Item):
    name: _Name
    corners: Annotated[list[_Point], Field(min_length=3, max_length=50)]
    factor: Annotated[float, Field(ge=0.05, le=1)]


class _EventItem(_Item):
    at_s: _Seconds
    do: Action
    name: _NameOrNone = ""
    level: _Level = 1.0


_Things = Field(max_length=MOST_THINGS)


class WorldFile(_Item):
    """One world file. Lengths are metres, z up; angles degrees, 0 = +x, counter-clockwise; times seconds from the start."""

    format: Literal[1]
    name: _Name
    title: Annotated[str, Field(min_length=1, max_length=80), AfterValidator(one_line)]
    source: Annotated[str, Field(max_length=2000), AfterValidator(lines)]
    paper: _NameOrNone = ""
    about: Annotated[str, Field(max_length=300), AfterValidator(lines)] = ""
    floor_colour: _Colour
    ceiling_colour: _Colour
    walls: Annotated[list[_WallItem], Field(min_length=3, max_length=MOST_WALLS)]
    starts: Annotated[list[_StartItem], Field(min_length=1, max_length=MOST_THINGS)]
    places: Annotated[list[_PlaceItem], _Things] = []
    doors: Annotated[list[_DoorItem], _Things] = []
    lamps: Annotated[list[_LampItem], _Things] = []
    daylight: _DaylightItem | None = None
    boxes: Annotated[list[_BoxItem], _Things] = []
    people: Annotated[list[_PersonItem], Field(max_length=MOST_PEOPLE)] = []
    slow_zones: Annotated[list[_ZoneItem], _Things] = []
    script: Annotated[list[_EventItem], Field(max_length=MOST_EVENTS)] = []

    def world(self) -> World:
        """The World that the simulator uses; angles become radians, colours become triples."""
        return World(
            name=self.name,
            title=self.title,
            source=self.source,
            paper=self.paper,
            about=self.about,
            walls=tuple(map(_wall, self.walls)),
            starts=tuple(map(_start, self.starts)),
            places=tuple(map(_place, self.places)),
            floor_colour=_rgb(self.floor_colour),
            ceiling_colour=_rgb(self.ceiling_colour),
            doors=tuple(map(_door, self.doors)),
            lamps=tuple(map(_lamp, self.lamps)),
            daylight=self.daylight and _daylight(self.daylight),
            boxes=tuple(map(_box, self.boxes)),
            people=tuple(map(_person, self.people)),
            slow_zones=tuple(map(_zone, self.slow_zones)),
            script=tuple(map(_event, self.script)),
        )


def element_of(kind: str, item: dict[str, Any]) -> Element:
    """An item of one of the file's lists, as an element. Raises pydantic's ValidationError."""
    model, make = _MAKERS[kind]
    return make(model.model_validate(item))


def _start(item: _StartItem) -> Start:
    return Start(item.name, item.x, item.y, math.radians(item.heading_deg))


def _place(item: _PlaceItem) -> Place:
    return Place(item.name, item.x, item.y)


def _lamp(item: _LampItem) -> Lamp:
    return Lamp(item.name, item.x, item.y, item.reach, item.brightness, item.on)


def _zone(item: _ZoneItem) -> SlowZone:
    return SlowZone(item.name, _points(item.corners), item.factor)


def _wall(item: _WallItem) -> Wall:
    (x1, y1), (x2, y2) = item.start, item.end
    panels = tuple(
        Panel(p.at, p.width, p.bottom, p.top, p.texture, _rgb(p.colour), p.seed, p.side) for p in item.panels
    )
    return Wall(
        x1, y1, x2, y2, item.kind, item.height, _rgb(item.colour), item.outer, item.bottom, panels, item.name, item.reflection
    )  # fmt: skip


def _door(item: _DoorItem) -> Door:
    x, y = item.hinge
    return Door(
        item.name, x, y, math.radians(item.angle_deg), item.width, item.height, _rgb(item.colour),
        math.radians(item.swing_deg), item.slides, item.open, item.period_s, item.open_s, item.phase_s,
    )  # fmt: skip


def _box(item: _BoxItem) -> Box:
    angle, colour = math.radians(item.angle_deg), _rgb(item.colour)
    return Box(item.name, item.x, item.y, item.width, item.depth, item.height, angle, colour, item.present)


def _person(item: _PersonItem) -> Person:
    path = _points(item.path)
    waits = tuple(item.wait_s) if len(item.wait_s) > 1 else (item.wait_s[0],) * len(path)
    return Person(item.name, path, waits, item.speed, item.loop, item.radius, item.height, _rgb(item.colour))


def _daylight(item: _DaylightItem) -> Daylight:
    return Daylight(tuple(p[0] for p in item.points), tuple(p[1] for p in item.points), item.repeat_s)


def _event(item: _EventItem) -> Event:
    return Event(item.at_s, item.do, item.name, item.level)


def _points(points: list[list[float]]) -> tuple[tuple[float, float], ...]:
    return tuple((x, y) for x, y in points)


def _rgb(text: str) -> Rgb:
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


_MAKERS: dict[str, tuple[type[_Item], Callable[[Any], Element]]] = {
    "walls": (_WallItem, _wall),
    "starts": (_StartItem, _start),
    "places": (_PlaceItem, _place),
    "doors": (_DoorItem, _door),
    "lamps": (_LampItem, _lamp),
    "boxes": (_BoxItem, _box),
    "people": (_PersonItem, _person),
    "slow_zones": (_ZoneItem, _zone),
    "script": (_EventItem, _event),
    "daylight": (_DaylightItem, _daylight),
}
LISTS = {kind: model for kind, (model, _) in _MAKERS.items()}  # the model of the items of each list


def world_to_json(world: World) -> str:
    """The text of a world file, one line for each item. Read again, it gives an equal world."""
    return WorldText().of(world)


class WorldText:
    """Writes one world after another. Walls that are the same objects as in the last one are not converted again, which
    would take half a second for ten thousand walls."""

    def __init__(self) -> None:
        self._lines: dict[int, tuple[Wall, str]] = {}  # by id; the wall is kept, so that its id stays its own

    def of(self, world: World) -> str:
        """The same text as `world_to_json`."""
        known, lines = self._lines, {}
        for wall in world.walls:
            lines[id(wall)] = known.get(id(wall)) or (wall, json.dumps(_wall_item(wall)))
        self._lines = lines
        return _text(world, [lines[id(wall)][1] for wall in world.walls])


def _text(world: World, walls: list[str]) -> str:
    head = {"format": 1, "name": world.name, "title": world.title, "source": world.source}
    head |= {key: text for key, text in (("paper", world.paper), ("about", world.about)) if text}
    head |= {"floor_colour": _hex(world.floor_colour), "ceiling_colour": _hex(world.ceiling_colour)}
    lists: dict[str, list[dict[str, Any]]] = {
        "starts": [{"name": s.name, "x": s.x, "y": s.y, "heading_deg": _degrees(s.heading_rad)} for s in world.starts],
        "places": [{"name": p.name, "x": p.x, "y": p.y} for p in world.places],
        "doors": [_door_item(door) for door in world.doors],
        "lamps": [
            {"name": k.name, "x": k.x, "y": k.y, "reach": k.reach, "brightness": k.brightness, "on": k.on}
            for k in world.lamps
        ],
        "boxes": [_box_item(box) for box in world.boxes],
        "people": [_person_item(person) for person in world.people],
        "slow_zones": [
            {"name": z.name, "corners": [*map(list, z.corners)], "factor": z.factor} for z in world.slow_zones
        ],
        "script": [{"at_s": e.at_s, "do": e.do, "name": e.name, "level": e.level} for e in world.script],
    }
    lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in head.items()]
    if world.daylight is not None:
        day = world.daylight
        course = {"points": [*map(list, zip(day.at_s, day.level, strict=True))], "repeat_s": day.repeat_s}
        lines.append(f'  "daylight": {json.dumps(course)}')
    for key, texts in {"walls": walls, **{key: [*map(json.dumps, items)] for key, items in lists.items()}}.items():
        if texts:
            rows = ",\n".join(f"    {text}" for text in texts)
            lines.append(f'  "{key}": [\n{rows}]')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _wall_item(wall: Wall) -> dict[str, Any]:
    item: dict[str, Any] = {"from": [wall.x1, wall.y1], "to": [wall.x2, wall.y2], "kind": wall.kind}
    item |= {"height": wall.height, "colour": _hex(wall.colour)}
    item |= {"name": wall.name} if wall.name else {}
    item |= {"outer": True} if wall.outer else {}
    item |= {"bottom": wall.bottom} if wall.bottom else {}
    item |= {"reflection": wall.reflection} if wall.kind == "glass" else {}
    panels = [
        {
            "at": p.at, "width": p.width, "bottom": p.bottom, "top": p.top, "texture": p.texture,
            "colour": _hex(p.colour), "seed": p.seed, "side": p.side,
        }
        for p in wall.panels
    ]  # fmt: skip
    return item | ({"panels": panels} if panels else {})


def _door_item(door: Door) -> dict[str, Any]:
    return {
        "name": door.name, "hinge": [door.x, door.y], "angle_deg": _degrees(door.angle_rad), "width": door.width,
        "height": door.height, "colour": _hex(door.colour), "swing_deg": _degrees(door.swing_rad), "slides": door.slides,
        "open": door.open, "period_s": door.period_s, "open_s": door.open_s, "phase_s": door.phase_s,
    }  # fmt: skip


def _box_item(box: Box) -> dict[str, Any]:
    return {
        "name": box.name, "x": box.x, "y": box.y, "width": box.width, "depth": box.depth, "height": box.height,
        "angle_deg": _degrees(box.angle_rad), "colour": _hex(box.colour), "present": box.present,
    }  # fmt: skip


def _person_item(person: Person) -> dict[str, Any]:
    return {
        "name": person.name, "path": [*map(list, person.path)], "speed": person.speed, "wait_s": list(person.wait_s),
        "loop": person.loop, "radius": person.radius, "height": person.height, "colour": _hex(person.colour),
    }  # fmt: skip


def _hex(rgb: Rgb) -> str:
    return "#{:02X}{:02X}{:02X}".format(*rgb)


def _degrees(angle: float) -> float:
    """Degrees that convert back to exactly this angle, if there are any; a short number where that is enough."""
    near = math.degrees(angle)
    beside = (math.nextafter(near, side) for side in (-math.inf, math.inf))
    return next((d for d in (round(near, 9), near, *beside) if math.radians(d) == angle), near)

from .params import OfficeParams, SimParams
from .sensors import SONAR_ANGLES_RAD
from .simulator import Drive, SensorFrame, Simulator, Truth
from .world import DEFAULT_WORLD, own_worlds
from .world.drawing import Drawing, draw_world
from .world.free_space import FreeSpace
from .world.world import Box, Daylight, Door, Event, Lamp, Panel, Person, Place, SlowZone, Start, Wall, World
from .world.world_file import WorldError, load_world, world_from_json, world_names
from .world.world_schema import WorldFile, WorldText, world_to_json

__all__ = [
    "DEFAULT_WORLD",
    "SONAR_ANGLES_RAD",
    "Box",
    "Daylight",
    "Door",
    "Drawing",
    "Drive",
    "Event",
    "FreeSpace",
    "Lamp",
    "OfficeParams",
    "Panel",
    "Person",
    "Place",
    "SensorFrame",
    "SimParams",
    "Simulator",
    "SlowZone",
    "Start",
    "Truth",
    "Wall",
    "World",
    "WorldError",
    "WorldFile",
    "WorldText",
    "draw_world",
    "load_world",
    "own_worlds",
    "world_from_json",
    "world_names",
    "world_to_json",
]

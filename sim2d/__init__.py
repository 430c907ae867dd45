"""The simulated office: worlds as data, a robot in pymunk, its camera, sonars and odometry."""

from sim2d.params import OfficeParams, SimParams
from sim2d.sensors.ranges import SONAR_ANGLES_RAD
from sim2d.simulator import Drive, SensorFrame, Simulator, Truth
from sim2d.world import own_worlds
from sim2d.world.drawing import Drawing, draw_world
from sim2d.world.elements import Box, Daylight, Door, Event, Lamp, Person, SlowZone
from sim2d.world.free_space import FreeSpace
from sim2d.world.world import Panel, Place, Start, Wall, World
from sim2d.world.world_file import DEFAULT_WORLD, WorldError, load_world, world_from_json, world_names
from sim2d.world.world_schema import WorldFile
from sim2d.world.world_writer import WorldText, world_to_json

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

"""What the server asks of the engine beside commands, and the answers to both."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import dataclass

from sim2d.world.world import World
from web.messages.commands import Command


@dataclass(frozen=True, slots=True)
class ReadExperience:
    """The answer's `result` is an ExperienceReport."""

    experience: int


@dataclass(frozen=True, slots=True)
class ReadBrain:
    """The answer's `result` is a copy of the whole brain, the engine's own class, which nobody drives."""


@dataclass(frozen=True, slots=True)
class Warn:
    """Put a warning on the timeline."""

    text: str


@dataclass(frozen=True, slots=True, eq=False)
class UseBrain:
    """Start anew with this brain, the engine's own class; what cannot be used is refused.

    In the same world and with the same seed, or in a world as its file has it, and with its seed.
    """

    brain: object
    world: World | None = None
    seed: int | None = None


class ReadWorld:
    """The answer's `result` is the World as it is now and its OfficeEdition."""


@dataclass(frozen=True, slots=True)
class ReadFiled:
    """The answer's `result` is the World of this name as it was last read from its file, or written there; None if never."""

    name: str


@dataclass(frozen=True, slots=True, eq=False)
class OpenWorld:
    """Begin anew in this world, which has been checked. The answer's `result` is the name that it got."""

    world: World
    filed: bool = True  # False: it is in no file yet, and would be lost


@dataclass(frozen=True, slots=True, eq=False)
class WorldSaved:
    """The world that was read has been saved, named as `world` is."""

    was: World
    world: World


@dataclass(frozen=True, slots=True)
class WorldDeleted:
    """The saved world of this name is in no file any more. Where it is open, it stays until another is opened."""

    name: str


@dataclass(frozen=True, slots=True)
class WorldRestored:
    """It is in its file again."""

    name: str
    title: str


EngineRequest = (
    ReadExperience
    | ReadBrain
    | Warn
    | UseBrain
    | ReadWorld
    | ReadFiled
    | OpenWorld
    | WorldSaved
    | WorldDeleted
    | WorldRestored
)  # what no command can hold; goes the same way


@dataclass(frozen=True, slots=True)
class Accepted:
    tick: int  # the tick before which the command took effect
    result: object = None  # what the server asked for


@dataclass(frozen=True, slots=True)
class Refused:
    """Why a command did nothing: which field, its value, and what would be right."""

    field: str
    value: object
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """A command or a request of the server on its way to the engine, with the place where its answer will appear."""

    command: Command | EngineRequest
    answer: Future[Accepted | Refused]

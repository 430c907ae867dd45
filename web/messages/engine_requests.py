"""The server's own requests to the engine, and the answers to requests and commands."""

from __future__ import annotations

from concurrent.futures import Future
from dataclasses import dataclass
from typing import ClassVar

from sim2d.world.world import World
from web.messages.commands import Command, Needs
from web.messages.situation import OpenSituation, ReadSituation


@dataclass(frozen=True, slots=True)
class ReadExperience:
    """The answer's `result` is an ExperienceReport."""

    experience: int


@dataclass(frozen=True, slots=True)
class ReadBrain:
    """The answer's `result` is a copy of the whole brain, of the engine's own class; nothing runs it."""


@dataclass(frozen=True, slots=True)
class ReadSession:
    """The answer's `result` is a copy of the whole session as a disk.State; nothing runs it."""


@dataclass(frozen=True, slots=True)
class Warn:
    """Put a warning on the timeline."""

    text: str


@dataclass(frozen=True, slots=True, eq=False)
class UseBrain:
    """Start anew with this brain, of the engine's own class. A brain that cannot be used is refused.

    It starts in the same world with the same seed or, when they are given, in `world` and with `seed`.
    """

    brain: object
    world: World | None = None
    seed: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class GoOn:
    """Go on with a run that was kept. run, session: of the engine's own classes; the session is where the run was left."""

    run: object
    session: object


@dataclass(frozen=True, slots=True, eq=False)
class PlayRecording:
    """Begin a run that plays a recording. player: of the engine's own class. One that cannot be played is refused."""

    player: object


class ReadWorld:
    """The answer's `result` is the World as it is now and its OfficeEdition."""

    needs: ClassVar[Needs] = "office"


@dataclass(frozen=True, slots=True)
class ReadFiled:
    """The answer's `result` is the World of this name as last read from or written to its file; None if never."""

    name: str


@dataclass(frozen=True, slots=True, eq=False)
class OpenWorld:
    """Begin anew in this world, which has been checked. The answer's `result` is the name that it got."""

    world: World
    filed: bool = True  # False: it is in no file yet, and would be lost


@dataclass(frozen=True, slots=True, eq=False)
class WorldSaved:
    """The world that was read has been saved under the name of `world`."""

    needs: ClassVar[Needs] = "office"
    was: World
    world: World


@dataclass(frozen=True, slots=True)
class WorldDeleted:
    """The saved world of this name is no longer in any file. If it is open, it stays until another is opened."""

    name: str


@dataclass(frozen=True, slots=True)
class WorldRestored:
    """The world of this name is in its file again."""

    name: str
    title: str


EngineRequest = (
    ReadExperience
    | ReadBrain
    | ReadSession
    | Warn
    | UseBrain
    | GoOn
    | ReadWorld
    | ReadFiled
    | OpenWorld
    | WorldSaved
    | WorldDeleted
    | WorldRestored
    | PlayRecording
    | ReadSituation
    | OpenSituation
)  # what no command can hold; it takes the same way
READS = (ReadBrain, ReadSession)  # what the program keeps now and then; nobody waits to be shown anything


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

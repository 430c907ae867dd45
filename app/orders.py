"""What a session can be told between two ticks. ValueError says why an order cannot be carried out; nothing has changed
then."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from app.comparing import Comparing
from app.config import Config, Value
from app.evaluation import Evaluation
from app.hand_packet import put_packet
from app.order_book import UNCHANGED, Order, order
from app.pilot import Mode, Pilot
from app.pilot.goal_place import nearest_to, of_its_place
from disk.words import one_line
from ratslam_core import RatSlam
from sim2d import Box, SensorFrame, Simulator, World

MOST_TAGS = 24


class Orders(Comparing):
    """The orders of a session, which inherits them. Those marked are kept with a run and can be given again."""

    world: World
    config: Config
    simulator: Simulator
    brain: RatSlam
    pilot: Pilot
    evaluation: Evaluation
    tags: dict[str, int]  # name -> the experience that was active when somebody gave it
    frame: SensorFrame
    on_order: Callable[[Order], object]  # is told of each order that was carried out
    under_orders: bool

    @property
    def tick_count(self) -> int:
        return self.frame.tick

    @property
    def time_s(self) -> float:
        return self.frame.time_s

    # ------------------------------------------------------------ to the robot

    @order
    def set_goal(self, x: float, y: float) -> int:
        """Go to the place (x, y), metres in the map's frame: to the quickest of all experiences that stand for it. Returns
        the one nearest to it."""
        return self.go_to_place_of(nearest_to(self.brain.experience_map, x, y, self.pilot.params))

    @order
    def go_to_place_of(self, experience: int) -> int:
        """Go to this experience or another of its place. Returns the first of them."""
        first, *others = of_its_place(self.brain.experience_map, experience, self.pilot.params)
        self.pilot.set_goal(first, others)
        return first

    @order
    def go_to(self, experience: int) -> None:
        """Go to this very experience."""
        self.pilot.set_goal(experience)

    @order
    def cancel_goal(self) -> None:
        self.pilot.cancel_goal()

    @order
    def tag(self, name: str) -> int:
        """Name the place where the robot believes itself to be, as "the kitchen", to send it there later. A name that is
        given again moves. Returns the active experience. IROS 2005 IV."""
        name = one_line(name.strip())
        if not name:
            raise ValueError("a tag needs a name")
        if name not in self.tags and len(self.tags) >= MOST_TAGS:
            raise ValueError(f"{name!r} would be tag number {MOST_TAGS + 1}; {MOST_TAGS} are enough, remove one first")
        self.tags[name] = self.brain.experience_map.active
        return self.tags[name]

    @order
    def untag(self, name: str) -> None:
        del self.tags[_tagged(self, name)]

    @order
    def go_to_tag(self, name: str) -> int:
        """Go to the place of this name, as after a click there. Returns its experience."""
        return self.go_to_place_of(self.tags[_tagged(self, name)])

    @order
    def set_mode(self, mode: Mode) -> None:
        self.pilot.set_mode(mode)

    @order
    def drive(self, speed: float, yaw_rate: float) -> object:
        """Drive by hand, m/s forwards and rad/s counter-clockwise, until the next such order. Who holds a key gives the same
        order sixty times a second: it is one order."""
        return None if self.pilot.drive(speed, yaw_rate) else UNCHANGED

    @order
    def kidnap(self, x: float | None = None, y: float | None = None, heading_rad: float | None = None) -> None:
        """Put the robot at (x, y), metres in the office's frame, untold. Without a place: a random free one."""
        if x is None and y is None:
            x, y, by_chance = self.simulator.random_free_pose()
            heading_rad = by_chance if heading_rad is None else heading_rad
        if x is None or y is None:
            raise ValueError("a kidnap needs both x and y, or neither for a place by chance")
        heading = self.simulator.truth.heading_rad if heading_rad is None else heading_rad
        self.simulator.teleport(x, y, heading)
        self.frame = self.simulator.observe()
        self.evaluation.kidnapped(self.time_s, self.brain.experience_map)
        if self.companion is not None:
            self.companion.evaluation.kidnapped(self.time_s, self.companion.brain.experience_map)

    @order
    def random_free_pose(self) -> tuple[float, float, float]:
        """A random pose where the robot fits now: x, y, heading. It advances the simulator's own generator."""
        return self.simulator.random_free_pose()

    # ------------------------------------------------------------ to the brain

    @order
    def put_packet(self, x: int, y: int, heading_rad: float = 0.0, share: float = 0.4) -> str:
        """Put a packet of activity into the pose cells by hand. Returns what was done, in words."""
        return put_packet(self.brain.pose_cells, x, y, heading_rad, share)

    @order
    def forget_view(self, view: int) -> None:
        """The brain forgets where it has seen this view."""
        self.brain.forget_view(view)

    def set_parameter(self, name: str, value: Value) -> bool:
        """Change one parameter. True if it takes effect at once, False if at the next reset."""
        self.set_parameters({name: value})
        return next(item.metadata["live"] for dotted, item, _ in self.config.items() if dotted == name)

    @order
    def set_parameters(self, values: Mapping[str, Value]) -> list[str]:
        """Change several parameters, all or none. Returns the names of those that wait for the next reset."""
        config = self.config.with_values(values)
        beside = None if self.companion is None else config.with_values(self.companion.values)
        changes: dict[str, dict[str, Value]] = {"robot": {}}  # robot first: only it can refuse (no room)
        waiting: list[str] = []
        for (dotted, item, old), (_, _, new) in zip(self.config.items(), config.items(), strict=True):
            section, key = dotted.split(".")
            if old != new and item.metadata["live"]:
                changes.setdefault(section, {})[key] = new
            elif old != new:
                waiting.append(dotted)
        for section, change in changes.items():
            if change:
                _take(self, section, change)
        self.config = config
        if self.companion is not None and beside is not None:
            self.companion.change(self.companion.config, beside)
        return waiting

    # ------------------------------------------------------------ to the office

    @order
    def edit_world(self, world: World) -> None:
        """Go on in an edited world; a reset begins in it, too. ValueError if something in it would cover the robot."""
        self.simulator.set_world(world)
        self.world = world

    @order
    def set_door(self, name: str, is_open: bool) -> None:
        """Open or shut a door. It moves from the next tick on and waits for anybody in its way."""
        self.simulator.set_door(name, is_open)

    @order
    def set_lamp(self, name: str, on: bool) -> None:
        self.simulator.set_lamp(name, on)

    @order
    def put_box(self, box: Box) -> None:
        """Put a new box down. ValueError if it would cover the robot or is outside."""
        self.simulator.put_box(box)

    @order
    def remove_box(self, name: str) -> None:
        self.simulator.remove_box(name)


def _tagged(session: Orders, name: str) -> str:
    if name not in session.tags:
        known = f"one of: {', '.join(session.tags)}" if session.tags else "given first; there is none yet"
        raise ValueError(f"there is no tag {name!r}; it must be {known}")
    return name


def _take(session: Orders, section: str, change: dict[str, Value]) -> None:
    """Hand the changed live parameters of a section to the part that uses them."""
    brain = session.brain
    if section == "robot":
        session.simulator.set_params(replace(session.simulator.params, **change))  # type: ignore[arg-type]
    elif section == "office":
        session.simulator.office = replace(session.simulator.office, **change)  # type: ignore[arg-type]
    elif section == "pilot":
        session.pilot.params = replace(session.pilot.params, **change)  # type: ignore[arg-type]
    else:
        brain.set_params(replace(brain.params, **{section: replace(getattr(brain.params, section), **change)}))

"""A whole session as a state and as a file: office, robot, brain, pilot and evaluation. A restored one goes on bit for
bit.

Two worlds are kept as the texts of their files and checked like any world file: the one that a reset begins in, and the
one that the robot is in, where boxes may have been put down. The rest must keep the laws below: of office and robot,
pilot, evaluation and second brain, of the last step and of the whole. The brain stands in front: it can be read
alone, also where another version knows the rest no more.
"""

# Laws read private attributes and do not trust annotations.
# pyright: reportPrivateUsage=false, reportUnnecessaryIsInstance=false

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import IO, cast, get_args

import numpy as np

from app.companion import SECTIONS, Companion, FirstDivergence
from app.config import Config
from app.evaluation import Evaluation
from app.evaluation.evaluation import Kidnapping, Stretch
from app.orders import SMALLEST_M
from app.pilot import Mode, Pilot, PilotParams
from app.pilot.bars import Bar, Bars
from app.pilot.behaviours import Behaviour
from app.pilot.explore import Explorer, Turn
from app.pilot.known_ground import LOOKS, KnownGround
from app.pilot.loop_closing import ASK_S
from app.pilot.opening import Opening
from app.pilot.route_following import RouteFollower
from app.pilot.seeking import Seeker
from app.pilot.stay import Stay
from app.pilot.tried import Tried
from app.session import LONGEST_NAME, MOST_TAGS, Session
from app.sources.simulated import Simulated
from disk import State, copy_state, decode, encode
from disk.archive import BROKEN
from disk.state_file import load_as, read_as, save_state
from disk.state_reading import words_of
from ratslam_core import Estimate, Odometry, RatSlam, Route, laws
from ratslam_core.brain_file import restore_snapshot
from ratslam_core.laws.brain import beats
from ratslam_core.laws.measures import FAR_M, array, number, pose, same_kind, true, whole, within
from sim2d import SONAR_ANGLES_RAD, OfficeParams, SensorFrame, SimParams, Simulator, World, world_from_json
from sim2d.actors.actors import Actors
from sim2d.actors.walkers import Walkers
from sim2d.importers.plan import empty_room
from web.messages import GoalState


def take_session(session: Session) -> State:
    """The whole state, as a copy: the session may go on."""
    return state_of(session.source.world_texts, copy_state(session))


def restore_session(state: State) -> Session:
    """A session in this state. It uses the state's arrays, not copies. ValueError says what is wrong with the state."""
    try:
        return _settled(state)
    except BROKEN as error:
        raise ValueError(words_of(error)) from None


def save_session(session: Session, path: Path | str) -> None:
    """Write a session to one file (.npz: arrays, and JSON as bytes). After a failure the file is as it was before.

    OSError names the file. ValueError: the session is too large to be read again.
    """
    save_state(take_session(session), path)


def load_session(path: Path | str, begun: Session | None = None) -> Session:
    """The session that `save_session` wrote. begun: of a recording: another one that plays it. Of its session no laws are
    checked. ValueError names the file and what is wrong with it."""
    return load_as("session", path, partial(_settled, begun=begun))


def read_session(file: IO[bytes]) -> Session:
    """The session in an open file. ValueError says what is wrong with it."""
    return read_as("session", file, _settled)


def state_of(world_texts: tuple[str, str], copy: Session) -> State:
    """From a copy of a session (`disk.copy_state`) and its `world_texts`."""
    return encode((copy.brain, *(np.frombuffer(text.encode(), np.uint8) for text in world_texts), copy))


def load_its_brain(path: Path | str) -> RatSlam:
    """The brain in the file of a session, or of a brain alone. ValueError names the file and what is wrong with it."""
    return load_as("brain", path, _its_brain)


def _its_brain(state: State) -> RatSlam:
    whole = state.tree.get("state")
    parts = cast("dict[str, list[object]]", whole).get("tuple") if isinstance(whole, dict) else None
    return restore_snapshot(State({**state.tree, "state": parts[0]}, state.arrays) if parts else state)


def _settled(state: State, begun: Session | None = None) -> Session:
    parts = decode(state)
    if not isinstance(parts, tuple) or len(cast("tuple[object, ...]", parts)) not in (3, 4):  # 3: earlier programs
        raise ValueError("it must hold two worlds and a session")
    first_text, text, session = cast("tuple[object, ...]", parts)[-3:]
    if not isinstance(session, Session):
        raise ValueError(f"it must hold a session, got a {type(session).__name__}")
    if begun is not None:
        session.settle((), begun)
        return session
    first = _world_of(first_text, "the text of its first world")
    now = _world_of(text, "the text of its world", begins=False)
    if first == now:
        first = now
    check(session, now)
    session.settle((first, now))
    return session


def _world_of(text: object, name: str, *, begins: bool = True) -> World:
    text = array(name, text, np.uint8, (None,))
    return world_from_json(text.tobytes().decode(), "its world", SMALLEST_M, begins=begins)


# ------------------------------------------------------------ what is true of one between two ticks


def companion(companion: Companion, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the first brain has."""
    true(isinstance(companion, Companion), f"its second brain is a {type(companion).__name__}")
    for name in (companion.first, companion.name):
        true(isinstance(name, str) and 0 < len(name) <= LONGEST_NAME, "two brains that are compared must have names")
    same_kind("the second brain's config", companion.config, Config())
    true(isinstance(companion.values, dict), "what makes the difference must be a table")
    known = {name for name, _, _ in companion.config.items()}
    for name in companion.values:
        true(name in known and name.split(".")[0] in SECTIONS, f"{name!r} is no parameter of a brain")
    true(isinstance(companion.brain, RatSlam), f"the second brain is a {type(companion.brain).__name__}")
    laws.check(companion.brain)
    own = len(companion.brain.experience_map)
    evaluation(companion.evaluation, own)
    true(companion.ties is None, "a second brain in an office has no laser's scans to tie")
    true(isinstance(companion.estimate, Estimate), "what the second brain believes must be an estimate")
    number("since when there is a second brain", companion.since_s, 0.0, LONGEST_S)
    true(isinstance(companion.divergence, FirstDivergence), "how two brains differ must be a first divergence")
    true(isinstance(companion.counterpart, list), "the counterparts must be a list")
    true(len(companion.counterpart) <= experiences, f"there are {experiences} experiences to have a counterpart")
    for own_one in companion.counterpart:
        whole("a counterpart", own_one, -1, own - 1)


LONGEST_S = 1e12
MOST_TURNED = 1e9  # rad


def evaluation(evaluation: Evaluation, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the map has."""
    true(isinstance(evaluation, Evaluation), f"its evaluation is a {type(evaluation).__name__}")
    same_kind("evaluation", evaluation, Evaluation())
    rows = array("the path", evaluation._rows, np.float32, (None, 8))
    count = whole("the path's length", evaluation._count, 1, len(rows))
    within("the path", rows[:count], -MOST_TURNED, MOST_TURNED)
    active = array("active experiences", evaluation._experience, np.int32, (len(rows),))
    within("active experiences", active[:count], 0, experiences - 1)
    made = array("where experiences were made", evaluation._made_at, np.float64, (None, 4))
    true(len(made) >= experiences, f"where {experiences} experiences were made must be known or not, got {len(made)}")
    true(not np.isinf(made).any(), "where experiences were made must be a place, or not known")
    pose("odometry alone", evaluation._odometry)
    whole("visits that agree", evaluation._consistent, 0, whole("visits", evaluation._revisits))
    number("the path", evaluation.path_m, 0.0, LONGEST_S)
    for kidnap in evaluation.kidnaps:
        true(isinstance(kidnap, Kidnapping), "a kidnap must be one")
        _kidnap(kidnap, experiences)


def _kidnap(kidnap: Kidnapping, experiences: int) -> None:
    number("the time of a kidnap", kidnap.at_s, 0.0, LONGEST_S)
    pose("the map before a kidnap", kidnap.map_in_office)
    whole("what was known before a kidnap", kidnap.known, 0, experiences)
    whole("ticks before a kidnap", kidnap.ticks, 0)
    number("the way since a kidnap", kidnap._way_m, 0.0, FAR_M)
    true(isinstance(kidnap._noticed, bool), "whether a kidnap was noticed must be true or false")
    for name in ("after_s", "after_m", "joined_s", "consistent_s", "met_s"):
        _time(name, getattr(kidnap, name))
    for name in ("wrong", "_right", "_agrees"):
        stretch = getattr(kidnap, name)
        true(isinstance(stretch, Stretch), f"a kidnap's {name} must be a stretch")
        _time(f"{name} since", stretch.since_s)
        number(f"a kidnap's {name} at most", stretch.most_s, 0.0, LONGEST_S)
        number(f"a kidnap's {name} after", stretch.way_m, 0.0, FAR_M)


def _time(name: str, value: float | None) -> None:
    if value is not None:
        number(f"a kidnap's {name}", value, 0.0, LONGEST_S)


def pilot(pilot: Pilot, experiences: int) -> None:
    """ValueError names the first law that does not hold. experiences: how many the map has."""
    true(isinstance(pilot, Pilot), f"its pilot is a {type(pilot).__name__}")
    fresh = Pilot(PilotParams(), np.array(SONAR_ANGLES_RAD), np.random.default_rng(0))
    same_kind("pilot", pilot, fresh)
    true(pilot.mode in get_args(Mode), f"the mode must be one of {', '.join(get_args(Mode))}, got {pilot.mode!r}")
    true(pilot._behaviour in Behaviour.__members__, f"the pilot cannot be {pilot._behaviour!r}")
    place = array("the pilot's place", pilot._freeing._place, np.float64, (3,))
    within("the pilot's place", place, -MOST_TURNED, MOST_TURNED)
    _stay(pilot._freeing._stay)
    local = pilot._local
    true(np.array_equal(local._angles, SONAR_ANGLES_RAD), "the pilot must know the robot's sonars")
    scans = whole("scans that are remembered", local._scans, 1, 10**6)
    echoes = array("echoes", local._echoes, np.float64, (scans * len(SONAR_ANGLES_RAD), 2))
    true(not np.isnan(echoes).any(), "echoes must be places, or none")
    whole("the echoes' beat", local._beat, -1)
    beats(local._beats)
    _explorer(pilot._explorer)
    one = pilot._explorer._rng is pilot._rng is pilot._freeing._rng
    true(one, "all parts of the pilot must draw from one generator")
    _bars(pilot._bars)
    _seeker(pilot._seeker, experiences)
    shared = pilot._seeker._bars is pilot._bars
    true(shared, "who seeks must know the pilot's bars")
    if pilot._follower is not None:
        true(pilot._follower._bars is pilot._bars, "who follows a route must know the pilot's bars")
        _follower(pilot._follower, experiences)


def _explorer(explorer: Explorer) -> None:
    true(explorer._state in ("follow", "cross", "look"), f"the explorer cannot be in the state {explorer._state!r}")
    whole("the explorer's stage", explorer._stage, 0, 1)
    if explorer._turn is not None:
        true(isinstance(explorer._turn, Turn), "the explorer's turn must be one")
        number("what is left of the turn", explorer._turn.left, -MOST_TURNED, MOST_TURNED)


def _stay(stay: Stay) -> None:
    for value in vars(stay).values():
        number("the pilot's stay", value, -MOST_TURNED, MOST_TURNED)


def _follower(follower: RouteFollower, experiences: int) -> None:
    true(isinstance(follower, RouteFollower), "who follows a route must be a RouteFollower")
    same_kind("route follower", follower, RouteFollower(0))
    _stay(follower._headway._stay)
    true(isinstance(follower.goals, list) and len(follower.goals) > 0, "a route must lead to a goal")
    for goal in follower.goals:
        whole("the goal", goal, 0, experiences - 1)
    true(follower.state in get_args(GoalState), f"the way to a goal cannot be {follower.state!r}")
    true(isinstance(follower._cut_off, str), "what cuts a goal off must be words")
    if follower._route is not None:
        true(isinstance(follower._route, Route), "the route must be one")
        nodes = array("the route", follower._route.experiences, np.int64, (None,))
        within("the route", nodes, 0, experiences - 1)
        times = array("times of the route", follower._route.arrival_s, np.float64, (len(nodes),))
        within("times of the route", times, 0.0, LONGEST_S)
        whole("how far the route has been driven", follower._at, 0, len(nodes) - 1)


def _seeker(seeker: Seeker, experiences: int) -> None:
    ground = seeker.ground
    true(isinstance(ground, KnownGround), "known ground must be one")
    true(np.array_equal(ground._angles, SONAR_ANGLES_RAD), "known ground must know the robot's sonars")
    count = whole("experiences of the known ground", ground.count, 0, experiences)
    rows = len(array("times of visits", ground._last_s, np.float64, (None,)))
    true(rows >= count, "every experience must have a time of its last visit")
    array("times of making", ground._made_s, np.float64, (rows,))
    seen = array("what was seen of the ground", ground._seen_m, np.float32, (rows, len(SONAR_ANGLES_RAD)))
    within("what was seen of the ground", seen, 0.0, FAR_M)
    latest = array("the latest looks", ground._latest, np.float32, (LOOKS, len(SONAR_ANGLES_RAD)))
    within("the latest looks", latest, 0.0, FAR_M)
    for name, value in (("time", ground.now_s), ("way on new ground", ground.new_m)):
        number(f"the {name} of the known ground", value, 0.0, LONGEST_S)
    if seeker.follower is not None:
        _follower(seeker.follower, experiences)
    true(isinstance(seeker.explored, bool), "whether all is explored must be a truth value")
    true(isinstance(seeker.reason, str), "the reason of a trip must be words")
    openings = array("openings", seeker.openings, np.float64, (np.size(seeker.openings) // 2, 2))
    within("openings", openings, -FAR_M, FAR_M)
    for name, value in (("the trip", seeker._trip_s), ("the longest trip", seeker._trip_most_s)):
        number(name, value, 0.0, LONGEST_S)
    closer = seeker._closer
    times = array("times by the links", closer._times, np.float64, (np.size(closer._times),))
    true(not np.isnan(times).any(), "times by the links must be numbers")
    number("how long they are still taken for true", closer._ask_s, -LONGEST_S, ASK_S)
    for tried in (ground.tried, ground.missed, closer._begun, closer._sought):
        _tried(tried)
    leg = seeker._last_leg
    true(leg is None or leg is closer or isinstance(leg, Opening), "the last leg of a trip must be one")
    if leg is closer:
        whole("where a loop is to be closed", closer._goal, 0, min(experiences, len(times)) - 1)
    if isinstance(leg, Opening):
        whole("from where an opening was seen", leg.experience, 0, experiences - 1)
        pose("an opening", leg.place)
        number("how near to the opening it came", leg._nearest_m, 0.0)


def _tried(tried: Tried) -> None:
    true(isinstance(tried, Tried), "what was tried in vain must be remembered")
    number("how near to a place it counts", tried._about_m, 0.0)
    number("how long it is left alone at first", tried._again_s, 0.0)
    true(len(tried._places) == len(tried._until_s), "every place that was tried must have its time")
    for experience, x, y in tried._places:
        whole("by what a place that was tried lies", experience, 0)
        within("a place that was tried", np.array([x, y], np.float64), -FAR_M, FAR_M)
    within("until when it is left alone", np.array(tried._until_s, np.float64), 0.0, np.inf)


def _bars(bars: Bars) -> None:
    for bar in bars._bars:
        true(isinstance(bar, Bar), "a bar must be one")
        within("a bar", array("a bar", bar.ends, np.float64, (2, 2)), -FAR_M, FAR_M)
        number("what is left of a bar", bar.left_s, -LONGEST_S, LONGEST_S)
        number("how long a bar lasts", bar.lasts_s, 0.0, LONGEST_S)
        whole("failures at a bar", bar.failures, 1)


FASTEST = 1e3  # m/s and rad/s


def simulator(simulator: Simulator, world: World) -> None:
    """ValueError names the first law that does not hold. world: the world that the robot is in."""
    true(isinstance(simulator, Simulator), f"its simulator is a {type(simulator).__name__}")
    same_kind("parameters", simulator.params, SimParams())
    same_kind("office", simulator.office, OfficeParams())
    fresh = Simulator(empty_room("laws", "laws", 4.0, 4.0), simulator.params, 0, simulator.office)
    same_kind("simulator", simulator, fresh)
    whole("tick", simulator._tick)
    whole("the tick at which the rate changed", simulator._clock[0], 0, simulator._tick)
    number("the time at which the rate changed", simulator._clock[1], 0.0, LONGEST_S)
    _robot(simulator, world)
    _actors(simulator.actors, world, simulator.params.tick_s)
    whole("the sensors' seed", simulator._sensors._seed, 0, 2**64)
    x0, y0, x1, y1 = (number("a bound", bound, -FAR_M, FAR_M) for bound in simulator._sensors._bounds)
    true(x0 < x1 and y0 < y1, "the bounds must be from the least to the most")
    _frame(simulator._frame)


def _robot(simulator: Simulator, world: World) -> None:
    robot, (x0, y0, x1, y1) = simulator._robot, world.bounds
    number("the robot's x", robot.pose[0], x0, x1)
    number("the robot's y", robot.pose[1], y0, y1)
    number("the robot's heading", robot.pose[2], -MOST_TURNED, MOST_TURNED)
    for speed in (*robot.velocity, robot.spin, robot.speed, robot.yaw_rate, *simulator._motion):
        number("a speed of the robot", speed, -FASTEST, FASTEST)


def _actors(actors: Actors, world: World, tick_s: float) -> None:
    doors, boxes, lamps = len(world.doors), len(world.boxes), len(world.lamps)
    for name in ("opening", "_wanted"):
        within(f"doors: {name}", array(f"doors: {name}", getattr(actors, name), np.float64, (doors,)), 0.0, 1.0)
    automatic = actors._automatic
    true(
        len(automatic) == doors and all(known is None or isinstance(known, bool) for known in automatic),
        f"doors: what they did by themselves must be known or not of all {doors}",
    )
    array("boxes", actors.box_present, np.bool_, (boxes,))
    array("boxes that are to come", actors._box_wanted, np.bool_, (boxes,))
    array("lamps", actors.lamp_on, np.bool_, (lamps,))
    number("daylight", actors.daylight, 0.0, FAR_M)
    if actors._level is not None:
        number("the script's daylight", actors._level, 0.0, FAR_M)
    whole("the next line of the script", actors._next, 0, len(world.script))
    number("the actors' time", actors._time_s, -1.0, LONGEST_S)
    for owner in (actors._tick_s, actors.walkers.tick_s):
        true(owner == tick_s, f"a tick must last {tick_s:g} s, got {owner:g}")
    _walkers(actors.walkers, world)


def _walkers(walkers: Walkers, world: World) -> None:
    n, x = len(world.people), np.array([len(person.path) for person in world.people], np.int64)
    x0, y0, x1, y1 = world.bounds
    xy = array("people", walkers.xy, np.float64, (n, 2))
    within("people: x", xy[:, 0], x0, x1)
    within("people: y", xy[:, 1], y0, y1)
    within("people: heading", array("people: heading", walkers.heading, np.float64, (n,)), -MOST_TURNED, MOST_TURNED)
    towards = array("people: where to", walkers._towards, np.int64, (n,))
    within("people: where to", towards, 0, np.iinfo(np.int64).max)
    true((towards < x).all(), "people must walk to a point of their path")
    way = array("people: way", walkers._way, np.int64, (n,))
    true((np.abs(way) == 1).all(), "people must walk forth or back")
    for name in ("_waits", "_patience"):
        values = array(f"people: {name[1:]}", getattr(walkers, name), np.float64, (n,))
        within(f"people: {name[1:]}", values, -LONGEST_S, LONGEST_S)
    array("people: present", walkers.present, np.bool_, (n,))
    within("people: numbers drawn", array("people: numbers drawn", walkers._drawn, np.int64, (n,)), 0, 2**53)
    bank = Walkers(world.people[:1], np.random.default_rng(0), 0.1, 0.0)._chance.shape[1]
    within("people: chance", array("people: chance", walkers._chance, np.float64, (n, bank)), 0.0, 1.0)


def _frame(frame: SensorFrame) -> None:
    whole("the frame's tick", frame.tick)
    number("the frame's time", frame.time_s, 0.0, LONGEST_S)
    number("the frame's length", frame.dt, 1e-6, LONGEST_S)
    array("the image", frame.image, np.uint8, (None, None, 3))
    ranges = array("the sonars", frame.ranges_m, np.float32, (8,))
    within("the sonars", ranges, -FAR_M, FAR_M)
    within("the laser", frame.laser_m, -FAR_M, FAR_M)
    for speed in (frame.odometry_speed, frame.odometry_yaw_rate):
        number("a speed that the odometry says", speed, -FASTEST, FASTEST)
    whole("the scene", frame.scene)


_PARTS = {"seed", "config", "source", "brain", "ties", "pilot", "evaluation", "odometry", "estimate", "tags"}


def check(session: Session, world: World) -> None:
    """ValueError names the first law that does not hold of a session in this world."""
    odd = (vars(session).keys() - {"companion"}) ^ (_PARTS | set(Session.CACHES))
    true(not odd, f"a session differs in {', '.join(sorted(odd))}: it was made by another version")
    whole("seed", session.seed, 0, 2**64)
    same_kind("config", session.config, Config())
    true(isinstance(session.source, Simulated), f"its source is a {type(session.source).__name__}")
    true(session.ties is None, "a brain in an office has no laser's scans to tie")
    simulator(session.simulator, world)
    true(isinstance(session.brain, RatSlam), f"its brain is a {type(session.brain).__name__}")
    laws.check(session.brain)
    occupancy, n = session.brain.occupancy, len(session.brain.experience_map)
    true(
        occupancy is not None and np.array_equal(occupancy._angles, SONAR_ANGLES_RAD),
        "its brain has other sonars than its robot",
    )
    pilot(session.pilot, n)
    evaluation(session.evaluation, n)
    true(isinstance(session.tags, dict) and len(session.tags) <= MOST_TAGS, "tags must be a table, and not too many")
    for name, experience in session.tags.items():
        true(isinstance(name, str) and 0 < len(name) <= LONGEST_NAME, f"a tag must have a name, got {name!r}")
        whole(f"the experience tagged {name!r}", experience, 0, n - 1)
    _last_step(session, n, len(session.brain.local_view))
    if session.companion is not None:
        companion(session.companion, n)


def _last_step(session: Session, experiences: int, views: int) -> None:
    told, estimate = session.odometry, session.estimate
    true(isinstance(told, Odometry), "the odometry must be one")
    for name in ("speed", "yaw_rate", "dt"):
        number(f"the odometry's {name}", getattr(told, name), -1e6, 1e6)
    true(isinstance(estimate, Estimate), "the estimate must be one")
    whole("the estimate's experience", estimate.experience, 0, experiences - 1)
    pose("the estimate's pose", estimate.pose_map_robot)
    for name in ("view", "best_view"):
        whole(f"the estimate's {name}", getattr(estimate.recognition, name), -1, views - 1)

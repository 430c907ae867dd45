"""The one engine thread: keeps the pace, takes commands between ticks, publishes snapshots. Waits for no browser."""

from __future__ import annotations

import math
import queue
import threading
import time
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace

from app.chronicle import Chronicle
from app.config import Config
from app.inspection import experience_report, inspect
from app.office_orders import carry_out
from app.packets import inject_packet
from app.session import Session
from app.snapshots import Snapshots
from app.tick_stages import TickRecorder
from app.world_editing import WorldEditor
from ratslam_core import RatSlam
from ratslam_core.brain_snapshot import take_snapshot
from sim2d import World, load_world, own_worlds, world_names
from web import messages as m
from web.latest import Latest

PUBLISH_EVERY_S = 1 / 20
HAND_EXPIRES_S = 0.3  # of wall time: what a person who lets go would expect at any speed
MOST_BEHIND_S = 0.25


class Runner:
    """Owns the session. `submit` may be called from any thread; everything else happens in the runner's own."""

    def __init__(
        self,
        world: World,
        seed: int,
        config: Config,
        *,
        speed: float = 1.0,
        running: bool = True,
        brain: RatSlam | None = None,
    ) -> None:
        self.latest: Latest[m.Snapshot] = Latest()
        self._own_worlds = {world.name: world}
        self._deleted: set[str] = set()  # their files are gone; the one that is open stays until another is
        self._titles = dict(world_names()) | dict(own_worlds.names())
        self._titles.setdefault(world.name, world.title)
        self._editor = WorldEditor(world)
        self._first = (world, seed, config, brain)
        self._requests: queue.SimpleQueue[m.Request | None] = queue.SimpleQueue()
        self._speed, self._running = speed, running
        self._fault: str | None = None
        self._run = 0
        self._hand_expires = math.inf
        self._due = self._published = 0.0
        self._factor = 0.0
        self._measured = (0.0, 0.0)
        self._stopping = False
        self._thread = threading.Thread(target=self._loop, name="engine", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread after the tick it is in."""
        self._stopping = True
        self._requests.put(None)
        self._thread.join()

    def submit(self, command: m.Command | m.Errand) -> Future[m.Accepted | m.Refused]:
        """Hand a command to the engine; the answer comes when it has taken effect or was refused."""
        answer: Future[m.Accepted | m.Refused] = Future()
        self._requests.put(m.Request(command, answer))
        return answer

    # ------------------------------------------------------------ the thread

    def _loop(self) -> None:
        self._begin(*self._first)
        while not self._stopping:
            self._take_requests()
            now = time.perf_counter()
            if now >= self._hand_expires:
                self._hand_expires = math.inf
                if self.session.pilot.mode == "manual":
                    self.session.pilot.drive(0.0, 0.0)
            if self._running and now >= self._due:
                self._tick()
                step = self.session.frame.dt / self._speed if self._speed > 0 else 0.0
                self._due = max(self._due + step, now - MOST_BEHIND_S)
            self._measure(now)
            if self._running and now - self._published >= PUBLISH_EVERY_S * 0.98:
                self._publish()

    def _begin(self, world: World, seed: int, config: Config, brain: RatSlam | None = None) -> None:
        """Another run, or none of it: what fails leaves the old one as it is."""
        session = Session(world, seed, config, brain, getattr(self, "session", None))
        self._forget(self._deleted - {world.name})
        chronicle = Chronicle(session)
        snapshots = Snapshots(session, chronicle, self._run + 1, tuple(self._titles.items()))
        if brain is not None:  # a foreign one has to be such that it can be shown
            snapshots.build(running=False, speed=1.0, real_time_factor=0.0, fault=None)
        self.session, self._chronicle, self._snapshots = session, chronicle, snapshots
        self._editor.begin(world)
        self._run += 1
        self._fault = None
        for words in config.warnings:
            self._chronicle.note("warning", words)
        self._hand_expires = math.inf
        self._due = time.perf_counter()
        self._publish()

    def _tick(self, recorder: TickRecorder | None = None) -> None:
        """One tick; whatever it throws pauses the session and says why."""
        self._snapshots.walk = None
        try:
            self.session.tick(recorder)
            self._chronicle.watch()
        except Exception as error:
            self._running = False
            self._fault = f"{type(error).__name__}: {error}"
            self._chronicle.note("fault", self._fault)
            traceback.print_exc()
            self._publish()

    def _take_requests(self) -> None:
        """Carry out all commands that wait; with none, sleep until the next tick or command."""
        wait = min(self._due, self._hand_expires) - time.perf_counter() if self._running else 0.5
        answers: list[tuple[m.Request, m.Accepted | m.Refused | Exception]] = []
        while True:
            try:
                request = self._requests.get(block=wait > 0 and not answers, timeout=min(max(wait, 0.0), 0.5))
            except queue.Empty:
                break
            if request is None:
                break
            answers.append((request, self._answer(request.command)))
        if answers:
            self._publish()  # first: who reads right after the answer sees what it did
        for request, answer in answers:
            if isinstance(answer, Exception):
                request.answer.set_exception(answer)
            else:
                request.answer.set_result(answer)

    def _answer(self, command: m.Command | m.Errand) -> m.Accepted | m.Refused | Exception:
        try:
            if isinstance(command, m.Errand):
                return self._run_errand(command)
            return self._carry_out(command) or m.Accepted(self.session.tick_count)
        except Exception as error:
            traceback.print_exc()
            return error

    def _measure(self, now: float) -> None:
        then, simulated = self._measured
        if now - then >= 1.0:
            run_s = self.session.time_s
            self._factor = max(0.0, run_s - simulated) / (now - then) if then else 0.0
            self._measured = (now, run_s)

    def _publish(self) -> None:
        self._published = time.perf_counter()
        speed = self._speed if self._speed > 0 else math.inf
        self._editor.follow(self.session.simulator.world)
        self._snapshots.office = self._editor.edition
        self.latest.put(
            self._snapshots.build(running=self._running, speed=speed, real_time_factor=self._factor, fault=self._fault)
        )

    def _run_errand(self, errand: m.Errand) -> m.Accepted | m.Refused:
        match errand:
            case m.ReadExperience(experience=experience):
                try:
                    report = experience_report(self.session, self._chronicle, experience)
                except ValueError as error:
                    return m.Refused("experience", experience, str(error))
                return m.Accepted(self.session.tick_count, report)
            case m.ReadBrain():
                return m.Accepted(self.session.tick_count, take_snapshot(self.session.brain))
            case m.UseBrain(brain=brain):
                return self._use(brain)
            case m.ReadWorld():
                self._editor.follow(self.session.simulator.world)
                return m.Accepted(self.session.tick_count, (self._editor.world, self._editor.edition))
            case m.OpenWorld() | m.WorldSaved():
                return self._receive(errand)
            case m.WorldDeleted() | m.WorldRestored():
                return self._file(errand)

    def _use(self, brain: object) -> m.Accepted | m.Refused:
        """A new run with a foreign brain in the same world; the old run goes on when that cannot be."""
        session = self.session
        try:
            if not isinstance(brain, RatSlam):
                raise TypeError(f"it is a {type(brain).__name__}")
            self._begin(session.world, session.seed, session.config.with_engine(brain.params), brain)
        except Exception as error:
            return m.Refused("brain", None, f"this brain cannot be used here: {error}")
        self._chronicle.note("brain", f"woke up with {len(brain.experience_map)} experiences")
        self._publish()
        return m.Accepted(0)

    def _receive(self, delivery: m.OpenWorld | m.WorldSaved) -> m.Accepted | m.Refused:
        """A world from a file, or news that the present one is in a file now."""
        world = delivery.world
        if isinstance(delivery, m.OpenWorld):
            world = self._own_worlds[world.name] if self._own_worlds.get(world.name) == world else self._new_name(world)
            was_faulty = self._fault is not None
            try:
                self._begin(world, self.session.seed, self.session.config)
            except ValueError as error:
                return m.Refused("world", world.name, str(error))
            self._running = self._running or was_faulty
            if not delivery.filed:
                self._editor.unfiled(world.name)
        else:
            self._editor.named(delivery.was, world, self.session.edit_world)
        self._own_worlds[world.name] = world
        self._deleted.discard(world.name)
        self._titles[world.name] = world.title
        self._snapshots.worlds = tuple(self._titles.items())
        return m.Accepted(self.session.tick_count, world.name)

    def _file(self, news: m.WorldDeleted | m.WorldRestored) -> m.Accepted:
        """A saved world's file has gone, or is there again."""
        if isinstance(news, m.WorldDeleted):
            self._editor.unfiled(news.name)
            self._deleted.add(news.name)
            self._forget({news.name} - {self.session.world.name})
        else:
            self._editor.filed(news.name)
            self._deleted.discard(news.name)
            self._titles[news.name] = news.title
        self._snapshots.worlds = tuple(self._titles.items())
        return m.Accepted(self.session.tick_count)

    def _forget(self, names: set[str]) -> None:
        for name in names:
            self._titles.pop(name, None)
            self._own_worlds.pop(name, None)
        self._deleted -= names

    def _new_name(self, world: World) -> World:
        """The same with a name that no other world has: plan, plan-2, plan-3."""
        name, k = world.name, 2
        while name in self._titles:
            name, k = f"{world.name[:36]}-{k}", k + 1
        return replace(world, name=name)

    # ------------------------------------------------------------ commands

    def _carry_out(self, command: m.Command) -> m.Refused | None:
        """Do what the command says; the field, its value and the reason when it cannot be."""
        before = self.session.config.warnings
        refused = self._obey(command)
        for words in self.session.config.warnings:
            if words not in before:
                self._chronicle.note("warning", words)
        return refused

    def _obey(self, command: m.Command) -> m.Refused | None:
        session, note = self.session, self._chronicle.note
        match command:
            case m.SetGoal(x=x, y=y):
                return self._try("x, y", (x, y), lambda: note("goal", f"to experience {session.set_goal(x, y)}"))
            case m.CancelGoal():
                session.pilot.cancel_goal()
            case m.SetMode(mode=mode):
                return self._try("mode", mode, lambda: session.set_mode(mode))
            case m.Drive(speed=speed, yaw_rate=yaw_rate):
                session.pilot.drive(speed, yaw_rate)
                self._hand_expires = time.perf_counter() + HAND_EXPIRES_S
            case m.Kidnap(x=x, y=y, heading_rad=heading):
                refused = self._try("x, y", (x, y), lambda: session.kidnap(x, y, heading))
                if refused is None:
                    note("kidnap", "carried away without being told")
                return refused
            case m.Pause():
                self._running = False
            case m.Resume():
                if self._fault is not None:
                    return m.Refused("type", "resume", f"the session stopped at a fault ({self._fault}); reset it")
                self._running, self._due = True, time.perf_counter()
            case m.Step(ticks=ticks):
                if self._fault is not None:
                    return m.Refused("type", "step", f"the session stopped at a fault ({self._fault}); reset it")
                self._running = False
                for _ in range(ticks):
                    self._tick()
                    if self._fault is not None or self._stopping:
                        break
            case m.StepStage(back=back):
                return self._step_stage(back)
            case m.SetSpeed(factor=factor):
                self._speed, self._due = factor, time.perf_counter()
            case m.Reset(world=name, seed=seed):
                return self._reset(name, seed)
            case m.SetParameter(name=name, value=value):
                return self._set_parameter(name, value)
            case m.SetDoor() | m.SetLamp() | m.PutBox() | m.RemoveBox() | m.UsePreset():
                return self._try("name", command.name, lambda: note("office", carry_out(session, command)))
            case m.InjectPacket():
                return self._try(
                    "x, y", (command.x, command.y), lambda: note("packet", inject_packet(session, command))
                )
            case m.EditWorld() | m.UndoEdit() | m.RedoEdit():
                return self._edit(command)
            case m.Inspect():
                chosen = command.model_dump(exclude={"type"}, exclude_none=True)
                return self._try(", ".join(chosen) or "type", list(chosen.values()), lambda: self._choose(command))
        self._snapshots.refresh()
        return None

    def _step_stage(self, back: bool) -> m.Refused | None:
        """The next stage of the tick that is shown, or the first of another tick; or the one before."""
        if self._fault is not None:
            return m.Refused("type", "step_stage", f"the session stopped at a fault ({self._fault}); reset it")
        shown = self._snapshots.walk
        following = None if shown is None else shown.moved(-1 if back else 1)
        if back and following is None:
            return m.Refused("back", True, "there is no stage before this one; go forwards")
        self._running = False
        self._snapshots.refresh()
        if following is None:
            recorder = TickRecorder(self.session, self._snapshots.parts())
            self._tick(recorder)
            self._snapshots.refresh()
            following = None if self._fault is not None else recorder.walk(self._snapshots.parts())
        self._snapshots.walk = following
        return None

    def _edit(self, order: m.EditOrder) -> m.Refused | None:
        editor, session = self._editor, self.session
        editor.follow(session.simulator.world)
        match order:
            case m.EditWorld():
                radius, free_in = session.simulator.params.robot_radius_m, session.simulator.free_in
                steps = [step.model_dump(exclude_none=True) for step in order.steps]
                return self._note("steps", steps, lambda: editor.edit(order, radius, session.edit_world, free_in))
            case m.UndoEdit():
                return self._note("type", order.type, lambda: editor.undo(session.edit_world))
            case m.RedoEdit():
                return self._note("type", order.type, lambda: editor.redo(session.edit_world))

    def _note(self, field: str, value: object, order: Callable[[], str]) -> m.Refused | None:
        return self._try(field, value, lambda: self._chronicle.note("office", order()))

    def _choose(self, wish: m.Inspect) -> None:
        inspect(self.session, self._chronicle, wish)
        self._snapshots.inspected = wish

    def _try(self, field: str, value: object, order: object) -> m.Refused | None:
        try:
            order()  # type: ignore[operator]
        except ValueError as error:
            return m.Refused(field, value, str(error))
        self._snapshots.refresh()
        return None

    def _reset(self, name: str | None, seed: int | None) -> m.Refused | None:
        session = self.session
        world = session.world
        if name is not None and name != world.name:
            if name not in self._titles:
                known = ", ".join(self._titles)
                return m.Refused("world", name, f"unknown world {name!r}; expected one of: {known}")
            try:
                world = self._own_worlds.get(name) or load_world(name)
            except ValueError as error:  # a saved one that somebody has spoilt since
                return m.Refused("world", name, str(error))
        was_faulty = self._fault is not None
        try:
            self._begin(world, session.seed if seed is None else seed, session.config)
        except ValueError as error:
            return m.Refused("world", world.name, str(error))
        self._running = self._running or was_faulty
        return None

    def _set_parameter(self, name: str, value: float | int | bool | str) -> m.Refused | None:
        session = self.session
        known = [dotted for dotted, _, _ in session.config.items()]
        try:
            live = session.set_parameter(name, value)
        except ValueError as error:
            field, wrong = ("value", value) if name in known else ("name", name)
            return m.Refused(field, wrong, str(error))
        self._chronicle.note("parameter", f"{name} = {value}" + ("" if live else ", from the next reset on"))
        return None

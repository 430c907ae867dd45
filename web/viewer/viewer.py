"""The viewers: for each look one viser server on the loopback, and one thread that draws snapshots and handles the pointer.

viser's callbacks only post to `_inbox`; everything that touches handles happens in that one thread. Every page is shown its own
look: two themes, each also with large letters for those who present, and without motions of its own. All but the first are built
when they are first needed.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from functools import partial
from typing import Any

import numpy as np
import viser

from web.latest import Latest
from web.messages import Accepted, Closure, Command, Refused, Snapshot
from web.switches import Switches
from web.themes import Look, Theme
from web.viewer.camera_views import VIEWS, Camera, ray_through
from web.viewer.cameras import Cameras, Robots
from web.viewer.layers import JudgedLayers, Layers
from web.viewer.motion import Motion
from web.viewer.pointer import NOT_THERE, OTHER_BRAIN, Answer, Click, Drag, Meaning, Pointer, ask
from web.viewer.primitives.palette import Palette, palette_of
from web.viewer.replay import Replay
from web.viewer.scenery import Beside, Scenery
from web.viewer.viser_server import guarded_server

DragEvent = viser.SceneNodeDragEvent[viser.MeshHandle]
FRAME_S = 1 / 30  # least time between two frames, however fast snapshots come
IDLE_S = 0.05  # longest time that a click waits
ARTIST_S = 0.005  # that what another thread has drawn waits


class Viewer:
    """Draws what `latest` holds in one look, and hands commands to `submit`, which must return at once."""

    def __init__(
        self, latest: Latest[Snapshot], submit: Callable[[Command], Future[Accepted | Refused]], switches: Switches,
        theme: Theme = "dark", large: bool = False, still: bool = False,
    ) -> None:  # fmt: skip
        """still: nothing moves but what the run moves, and cameras do not fly."""
        self.on_connect: Callable[[int], None] | None = None
        self.on_complaint: Callable[[int, str], None] | None = None
        self._latest, self._submit, self._switches = latest, submit, switches
        self._inbox: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None
        self._snapshot: Snapshot | None = None
        self.server, self.secret = guarded_server()
        self.port = self.server.get_port()
        self._cameras = Cameras(self.server, self._inbox.put)
        self._pointer = Pointer(self._send, self._complain)
        self._now_s = 0.0
        self._still = still
        self._set_up(palette_of(theme, large))
        self.server.on_client_connect(self._connected)
        self.server.on_client_disconnect(self._disconnected)

    def start(self) -> None:
        self._thread = threading.Thread(target=self._work, name="viewer", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Joins the thread and closes the server; may be called twice."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self._layers.stop()
        self.server.stop()

    @property
    def drawing(self) -> bool:
        """Something is being drawn in another thread."""
        return self._layers.drawing

    def turned(self, client_id: int) -> Camera | None:
        """Where somebody has turned this browser's camera by hand; None if nobody has."""
        return self._cameras.turned(client_id)

    def fly(self, client_id: int | None, view: str, at_once: bool = False, turned: Camera | None = None) -> None:
        """Takes one browser's camera (None: all) to a view: "all", "office", "pose" or "map"; `at_once`: without a flight.

        turned: where the camera had been turned by hand from that view."""
        if view not in VIEWS:
            raise ValueError(f"unknown view {view!r}; expected one of: {', '.join(VIEWS)}")
        now_s = None if at_once or self._still else time.monotonic()
        self._inbox.put(lambda: self._cameras.take_off(client_id, view, now_s, turned))

    def follow(self, client_id: int, on: bool) -> None:
        """From now on this browser's camera goes with the robot, or no longer."""
        self._inbox.put(lambda: self._cameras.follow(client_id, self._robots() if on else {}, time.monotonic()))

    def replay(self, event: int) -> None:
        """Plays the correction after this loop closure again, slowly, for all who look at this viewer."""
        self._inbox.put(lambda: self._replay.find(self._snapshot, event, self._now_s))

    def press(
        self, client_id: int, at: tuple[float, float], inspecting: bool, on_answer: Callable[[str | None], None]
    ) -> None:
        """Somebody has clicked on what this browser's camera shows: `at` as in `ray_through`. on_answer: as in `Click`."""

        def pressed() -> None:
            camera = self._cameras.standing(client_id)
            if camera is None:
                on_answer(NOT_THERE)
            else:
                self._click(Click(*ray_through(camera, at), on_answer), inspecting)

        self._inbox.put(pressed)

    def hover(self, client_id: int, at: tuple[float, float], on_words: Callable[[str], None]) -> None:
        """Somebody points there: what a click would do, in words; empty where it does nothing."""

        def pointed() -> None:
            camera = self._cameras.standing(client_id)
            if camera is None:
                on_words("")
            else:
                on_words(self.meaning(Click(*ray_through(camera, at), lambda _: None), False).words)

        self._inbox.put(pointed)

    def click(self, click: Click, inspecting: bool = False) -> None:
        """Somebody has clicked on the plates. inspecting: with shift."""
        self._inbox.put(lambda: self._click(click, inspecting))

    def drag(self, drag: Drag) -> None:
        """Somebody is dragging the robot."""
        self._inbox.put(lambda: self._drag(drag))

    def _work(self) -> None:
        seen = 0
        while not self._stopping.is_set():
            began_s = time.monotonic()
            wait_s = ARTIST_S if self.drawing else FRAME_S if self._cameras.flying else IDLE_S
            seen, snapshot = self._latest.wait(seen, wait_s)
            self.tick(snapshot, time.monotonic(), watched=bool(self.server.get_clients()))
            least_s = ARTIST_S if self.drawing else FRAME_S
            self._stopping.wait(max(0.0, least_s - (time.monotonic() - began_s)))

    def tick(self, snapshot: Snapshot | None, now_s: float, watched: bool = True) -> None:
        """One round: handle what people did, move cameras in flight, and draw the layers that are new and due."""
        self._now_s = now_s
        if snapshot is not None:
            if snapshot.sought(self._snapshot):
                self._layers.hurry()
            self._snapshot = snapshot
        with contextlib.suppress(queue.Empty):
            while True:
                self._inbox.get_nowait()()
        self._cameras.fly_on(now_s)
        if self._snapshot is not None and watched:
            with self.server.atomic():
                self._layers.draw(self._snapshot, now_s)
            self._cameras.track(self._robots(), now_s)

    def _rearranged(self, two: bool) -> None:
        """The plates stand elsewhere: two brains, or an office, have come or gone."""
        self._layers.forget("cells")
        assert self._snapshot is not None
        self._cameras.give_room(office=self._snapshot.world is not None, two=two)

    def _set_up(self, palette: Palette) -> None:
        """Builds the plates in a palette."""
        self._scenery = Scenery(self.server.scene, palette)
        self._beside = Beside(self.server.scene, palette, self._scenery, self._rearranged)
        self.server.gui.configure_theme(dark_mode=palette.dark, show_logo=False, show_share_button=False)
        office, map_plate = self._scenery.office, self._scenery.map
        judged = JudgedLayers(self.server.scene, palette, office, map_plate, self._switches)
        self._replay = Replay(map_plate)
        motion = None if self._still else Motion(self._scenery, self._replay)
        self._layers = Layers(
            self._scenery, self._beside, judged, self._replay, motion, self._pointer, self._switches, self._inbox.put
        )
        for part in office.robot.parts:
            part.on_drag("left")(self._dragged(False))
            part.on_drag("left", modifier="shift")(self._dragged(True))

    def _dragged(self, turning: bool) -> Callable[[DragEvent], Coroutine[Any, Any, None]]:
        async def dragged(event: DragEvent) -> None:  # async: keeps their order
            x, y, z = event.client.camera.position.tolist()
            self.drag(Drag(event.client_id, event.phase, turning, (x, y, z), event.end_position))

        return dragged

    def _connected(self, client: viser.ClientHandle) -> None:
        self._inbox.put(lambda: self._welcome(client))

    def _disconnected(self, client: viser.ClientHandle) -> None:
        self._inbox.put(lambda: self._cameras.farewell(client.client_id))

    def _click(self, click: Click, inspecting: bool) -> None:
        self.meaning(click, inspecting).act()

    def meaning(self, click: Click, inspecting: bool) -> Meaning:
        """Of the first of all that may lie there. In the viewer's thread."""
        lesson = None if self._snapshot is None or inspecting else self._snapshot.lesson
        predicted = self._scenery.lesson.predicted(lesson, click.origin, click.direction)
        if predicted is not None:
            answered = partial(click.answered, title="Nothing predicted")
            return Meaning("Click: predict this", lambda: self._send(predicted, answered))
        if self._beside.holds(click.origin, click.direction):
            return Meaning("", lambda: click.on_answer(OTHER_BRAIN))
        column = self._scenery.cells.column_at(np.array(click.origin), np.array(click.direction))
        if column is not None:
            return Meaning(
                "Click: inspect these pose cells", lambda: self._pointer.inspect(click, x=column[0], y=column[1])
            )
        if not inspecting and (closure := self._pointer.closure_at(click, self._scenery.map)) is not None:
            return Meaning("Click: see this correction again", lambda: self._see(closure, click))
        if inspecting or self._switches.is_on("click_inspects"):
            found = self._pointer.experience_at(click, self._scenery.map)
            words = "" if found is None else f"Click: inspect experience {found}"
            return Meaning(words, lambda: self._pointer.inspect(click, experience=found))
        places = self._snapshot.places if self._snapshot is not None else ()
        return self._pointer.meant(click, self._scenery.map, self._now_s, self._scenery.office, places)

    def _see(self, closure: Closure, click: Click) -> None:
        self._replay.start(closure, self._now_s)
        click.on_answer(None)

    def _robots(self) -> Robots:
        return {} if self._snapshot is None else self._scenery.robots(self._snapshot)

    def _drag(self, drag: Drag) -> None:
        if self._snapshot is None:
            return
        if self._snapshot.recording is None:
            self._pointer.drag(drag, self._scenery.office, self._snapshot)
        elif drag.phase == "end":
            self._complain(drag.client_id, "The robot stays where it is", "a recording plays: it goes where it went")

    def _send(self, command: Command, answered: Callable[[Answer], None]) -> None:
        ask(self._submit, command, lambda answer: self._inbox.put(lambda: answered(answer)))

    def _complain(self, client_id: int, title: str, body: str) -> None:
        if self.on_complaint is not None:
            self.on_complaint(client_id, f"{title}: {body}")

    def _welcome(self, client: viser.ClientHandle) -> None:
        self._cameras.welcome(client)
        if self.on_connect is not None:
            self.on_connect(client.client_id)


class Viewers:
    """May be used from any thread. A viewer that nobody looks at draws nothing."""

    def __init__(self, latest: Latest[Snapshot], submit: Callable[[Command], Future[Accepted | Refused]]) -> None:
        self._latest, self._submit = latest, submit
        self._lock = threading.Lock()
        self._built: dict[Look, Viewer] = {}
        self._started = self._stopped = False
        self.switches = Switches()  # one set for all pages, in all looks
        self.of("dark")  # at once: if viser is not available or cannot be guarded, that is said before the robot drives

    def of(self, theme: Theme, large: bool = False, still: bool = False) -> Viewer:
        """The viewer in a look; takes a second when it has to be built. Raises ConnectionError after `stop`."""
        with self._lock:
            if self._stopped:
                raise ConnectionError("the viewers are closed")
            look = Look(theme, large, still)
            if look not in self._built:
                self._built[look] = self._build(look)
            return self._built[look]

    def start(self) -> None:
        with self._lock:
            self._started = True
            for viewer in self._built.values():
                viewer.start()

    def stop(self) -> None:
        """May be called twice."""
        with self._lock:
            self._stopped = True
            for viewer in self._built.values():
                viewer.stop()

    def _build(self, look: Look) -> Viewer:
        viewer = Viewer(self._latest, self._submit, self.switches, *look)
        if self._started:
            viewer.start()
        return viewer

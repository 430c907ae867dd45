"""A viewer whose rounds a test runs itself, what it has sent, and what a browser that listens would hold of it."""

from __future__ import annotations

from collections import Counter
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np

from tests.patience import until
from web.latest import Latest
from web.messages import Accepted, Command, Refused, Snapshot
from web.switches import Name, Switches
from web.viewer import Viewer
from web.viewer.pointer import Click, Drag
from web.viewer.primitives import images

FAR_BELOW = -40.0  # what is put there cannot be seen


@dataclass
class Engine:
    """Notes commands, and answers when told to."""

    commands: list[Command] = field(default_factory=list)
    answers: list[Future[Accepted | Refused]] = field(default_factory=list)

    def submit(self, command: Command) -> Future[Accepted | Refused]:
        self.commands.append(command)
        self.answers.append(Future())
        return self.answers[-1]


class Bench:
    def __init__(self) -> None:
        self.engine, self.switches = Engine(), Switches()
        self.viewer = Viewer(Latest[Snapshot](), self.engine.submit, self.switches)
        self.now_s = 100.0
        self.sent: list[Any] = []
        self.complaints: list[tuple[int, str]] = []
        self.told: list[str | None] = []  # what came of each click: None when it was carried out
        self.viewer.on_complaint = lambda *complaint: self.complaints.append(complaint)
        server = self.viewer.server._websock_server
        pass_on = server.queue_message

        def queue_message(message: Any) -> None:
            self.sent.append(message)
            pass_on(message)

        server.queue_message = queue_message  # type: ignore[method-assign]

    def show(self, snapshot: Snapshot | None, later_s: float = 1.0) -> Counter[str]:
        """One round, `later_s` after the last; how many messages it sent about each node."""
        self.now_s += later_s
        before = len(self.sent)
        self.viewer.tick(snapshot, self.now_s)
        return Counter(getattr(message, "name", "") or type(message).__name__ for message in self.sent[before:])

    def settle(self) -> None:
        """Run rounds until everything that is due, or being drawn in another thread, is there."""
        until(lambda: not self.show(None, 3.0) and not self.viewer.drawing, "all is drawn")

    def switch(self, name: Name, on: bool) -> None:
        self.switches.turn(name, on)
        self.settle()

    # ------------------------------------------------------------ what a browser holds

    def nodes(self) -> dict[str, dict[str, Any]]:
        """All nodes with their properties, as a browser that connects now would receive them."""
        found: dict[str, dict[str, Any]] = {}
        for message in list(self.viewer.server._websock_server._broadcast_buffer.message_from_id.values()):
            name = getattr(message, "name", None)
            if name is None:
                continue
            node = found.setdefault(name, {"visible": True})
            told = message.props.__dict__ if hasattr(message, "props") else getattr(message, "updates", None)
            node.update(told if told is not None else {k: v for k, v in vars(message).items() if k != "name"})
        return found

    def node(self, name: str) -> dict[str, Any]:
        return self.nodes()[name]

    def visible(self, name: str, nodes: dict[str, dict[str, Any]] | None = None) -> bool:
        """Whether a node and all its parents are shown. nodes: all, for whoever asks of many."""
        nodes, parts = nodes or self.nodes(), name.strip("/").split("/")
        above = ["/" + "/".join(parts[: k + 1]) for k in range(len(parts))]
        return all(nodes[one]["visible"] for one in above if one in nodes)

    def shown(self, prefix: str) -> list[str]:
        """The nodes that are seen and whose names begin so."""
        nodes = self.nodes()
        return [name for name in nodes if name.startswith(prefix) and self.visible(name, nodes)]

    def at(self, name: str) -> tuple[float, float, float]:
        """Where a node stands in the scene."""
        nodes, parts = self.nodes(), name.strip("/").split("/")
        above = ["/" + "/".join(parts[: k + 1]) for k in range(len(parts))]
        x, y, z = np.sum([nodes[one].get("position", (0.0, 0.0, 0.0)) for one in above], axis=0).tolist()
        return x, y, z

    def on_map(self, xy: np.ndarray) -> np.ndarray:
        """Where places of the map lie on its plate."""
        return self.viewer._scenery.map.fit.to_plate(xy)

    def drawn(self, name: str, places: str = "points") -> np.ndarray:
        """The places of a node, without those far below everything."""
        at = np.asarray(self.node(name)[places])
        return at[(at > FAR_BELOW).all(tuple(range(1, at.ndim)))]

    def dots(self, places: str = "points", plate: str = "map") -> np.ndarray:
        """Of a map's experiences, which lie in several nodes: their places, or their colours."""
        names = [name for name in self.nodes() if name.startswith(f"/{plate}/nodes_")]
        names.sort(key=lambda name: int(name.split("_")[-1]))
        at = np.concatenate([np.asarray(self.node(name)["points"]) for name in names])
        there = (at > FAR_BELOW).all(1)
        return np.concatenate([np.asarray(self.node(name)[places]) for name in names])[there]

    # ------------------------------------------------------------ what people do

    def _towards(self, at: tuple[float, float, float]) -> Click:
        """From above, slightly slanted, at a place of the scene."""
        aim, eye = np.array(at), np.array([2.0, -20.0, 25.0])
        return Click(tuple(eye), tuple(aim - eye), self.told.append)

    def click(self, at: tuple[float, float, float], shift: bool = False) -> None:
        self.viewer.click(self._towards(at), shift)

    def meaning(self, at: tuple[float, float, float]) -> str:
        """What a click there would do."""
        return self.viewer.meaning(self._towards(at), False).words

    def drag(self, at: tuple[float, float, float], phase: Any, turning: bool = False) -> None:
        """Drag with the pointer over a place of the scene."""
        aim, eye = np.array(at), np.array([0.0, -25.0, 30.0])
        self.viewer.drag(Drag(7, phase, turning, tuple(eye), tuple(eye + 0.9 * (aim - eye))))
        self.show(None, 0.05)

    def answer(self, answer: Accepted | Refused, later_s: float = 0.05) -> None:
        self.engine.answers[-1].set_result(answer)
        self.show(None, later_s)

    def says(self, name: str, words: str) -> bool:
        """Whether a pill's picture shows exactly these words, whatever their colour."""
        ink = cv2.imdecode(np.frombuffer(self.node(f"{name}/words")["_data"], np.uint8), cv2.IMREAD_UNCHANGED)
        wanted = images.upright(images.text(words, (0, 0, 0), 72, True))
        return ink.shape == wanted.shape and np.array_equal(ink[..., 3], wanted[..., 3])

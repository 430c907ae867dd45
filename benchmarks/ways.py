"""How many files one has to open to follow a way through the program, and how the files are spread: `python -m benchmarks.ways`

Three ways are gone once, and then once more under a profiler that notes each file of ours in which a function runs:

- click to route: a click on the map's plate, `set_goal`, the tick in which it is carried out, and the drawn route. Bar: 35.
- image to stage: one tick with a camera image, its snapshot, and what the stage draws of it. Bar: 40.
- `experiment table`, quick, one trial in each cell: up to the first tick of a trial (bar: 20), and from there to the figures.

Engine, keeper and stage are those of `make run`. Before the first way comes the page's server, which hands a click to
`Viewer.press` (stream.py, proxy.py). Kernels, and what Python writes for data classes, run in no file. Then come files and lines
by folder, and who imports whom.
"""

# The viewer's rounds are run here, where else its own thread runs them.
# pyright: reportPrivateUsage=false

from __future__ import annotations

import argparse
import ast
import contextlib
import inspect
import io
import math
import os
import re
import sys
import tempfile
import textwrap
import threading
from collections import Counter, defaultdict
from collections.abc import Generator, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import msgspec
import numpy as np
import orjson
import viser
from distributed import LocalCluster
from websockets.sync.client import connect

from app.cli.command_line import main as command
from app.config import Config
from app.engine.engine import Engine
from app.engine_thread import EngineThread
from app.run_record.folder import runs_folder
from app.run_record.keyframes import PastRoom
from app.run_record.writer import RunKeeper
from app.session import Session
from disk import write_whole
from sim2d import DEFAULT_WORLD, load_world
from tests.patience import until
from web.messages import Snapshot
from web.viewer import Viewers
from web.viewer.camera_views import camera_for, seen_by
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.viser_server import SECRET_HEADER

ROOT = Path(__file__).resolve().parents[1]
ROOMS, BESIDE = ("ratslam_core", "sim2d", "disk", "app", "web"), ("tests", "benchmarks")
TABLE_WAYS = "experiment table to its first session", "that session to its first tick", "from there to the figures"
BARS = {"click to route": 35, "image to stage": 40, TABLE_WAYS[0]: 20}
MOST_FILES, LEAST_FILES = 20, 3  # of a folder
EXPLORED_TICKS = 2000
SLOW = 0.25  # 0.4 s between two ticks: time for one to be followed to the stage
ALL_DUE_S = 2.0  # between two rounds of the stage: whatever is new is drawn
ASPECT = 1.5  # of the browser's canvas
EXPERIMENT = ("experiment", "table", "--quick", "--trials", "1", "--engine", "ours")

Way = dict[str, None]  # files in the order in which they were first entered


@cache
def ours(name: str) -> str | None:
    """A Python file of our rooms, as a path from the root; None for any other."""
    path = Path(name)
    inside = path.suffix == ".py" and path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in ROOMS
    return path.relative_to(ROOT).as_posix() if inside else None


class Followed:
    """A profiler that notes in which files functions run, in one way or several that follow one another.

    ends: what ends each way but the last by being called. In the last, only what this thread enters is noted.
    """

    def __init__(self, *ends: CodeType) -> None:
        self._ends, self._here, self._noting = ends, threading.get_ident(), False
        self.ways: list[Way] = [{}]

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if not self._noting or event != "call" or not code.co_flags & inspect.CO_OPTIMIZED:
            return  # the body of a module or a class is no function
        left = self._ends[len(self.ways) - 1 :]
        if left and code is left[0]:
            self.ways.append({})
        elif self._ends and not left and threading.get_ident() != self._here:
            return
        if (file := ours(code.co_filename)) is not None:
            self.ways[-1][file] = None

    @contextlib.contextmanager
    def noted(self) -> Generator[None]:
        """What this thread does meanwhile, and others of which this is the profiler."""
        self.ways, self._noting = [{}], True
        sys.setprofile(self)
        try:
            yield
        finally:
            sys.setprofile(None)
            self._noting = False


# ------------------------------------------------------------ engine and stage


class Program:
    """Engine, keeper and stage, as `make run` puts them together, and a browser that is connected to the stage."""

    def __init__(self, followed: Followed) -> None:
        def begin(engine: Engine) -> None:
            engine.begin(load_world(DEFAULT_WORLD), 1, Config())
            for _ in range(EXPLORED_TICKS):
                engine.tick()
            sys.setprofile(followed)  # of the engine's thread

        self._runs, self._now_s = RunKeeper(print), 0.0
        self._engine = EngineThread(
            load_world(DEFAULT_WORLD), 1, Config(), speed=SLOW, keeper=self._runs,
            past_room=PastRoom(folder=runs_folder()), first=begin,
        )  # fmt: skip
        self._viewer = Viewers(self._engine.latest, self._engine.submit).of("dark")
        self._runs.start()
        self._engine.start()
        until(lambda: self._engine.latest.get()[0], "the engine has begun")
        self._browser = connect(
            f"ws://127.0.0.1:{self._viewer.port}/", subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            additional_headers={SECRET_HEADER: self._viewer.secret}, max_size=None, max_queue=None,
        )  # fmt: skip
        self._browser.send(_camera_told())
        until(self._viewer.server.get_clients, "a browser is connected")
        self.next()

    def close(self) -> None:
        self._browser.close()
        self._engine.stop()
        self._runs.stop()
        self._viewer.stop()

    def next(self) -> Snapshot:
        """The next tick, drawn on the stage."""
        seen = self._shown.tick
        until(lambda: self._shown.tick > seen, "the next tick")
        return self._draw(ALL_DUE_S)

    def click(self, experience: int) -> None:
        """On an experience, until the way there is drawn."""
        told: list[str | None] = []
        (client_id,), at = self._viewer.server.get_clients(), self._on_canvas(self._shown.map.xy[experience])
        self._viewer.press(client_id, at, False, told.append)
        until(lambda: self._draw(0.01) and told, "the click is answered")
        assert told == [None], told
        goal = self.next().goal
        assert goal is not None
        assert len(goal.route_xy) > 1

    @property
    def _shown(self) -> Snapshot:
        snapshot = self._engine.latest.get()[1]
        assert snapshot is not None
        return snapshot

    def _draw(self, later_s: float) -> Snapshot:
        snapshot, self._now_s = self._shown, self._now_s + later_s
        self._viewer.tick(snapshot, self._now_s)
        return snapshot

    def _on_canvas(self, map_xy: np.ndarray) -> tuple[float, float]:
        """Where the browser shows a place of the map, as a click tells it."""
        plate, camera = self._viewer._scenery.map, camera_for("all", ASPECT)
        point = np.array([*plate.fit.to_plate(map_xy[None])[0], NODE_Z]) + plate.origin
        away = np.linalg.norm(camera.look_at - camera.position) * math.tan(camera.fov_rad / 2)
        x, y = (seen_by(camera, point[None])[0][0] / away).tolist()
        return x, y


def _camera_told() -> bytes:
    """What a browser says first."""
    camera = camera_for("all", ASPECT)
    return msgspec.msgpack.encode({
        "type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": camera.position.tolist(),
        "look_at": camera.look_at.tolist(), "up_direction": (0.0, 0.0, 1.0), "fov": camera.fov_rad, "near": 0.1,
        "far": 900.0, "image_height": 800, "image_width": int(800 * ASPECT),
    })  # fmt: skip


def engine_ways() -> dict[str, Way]:
    """From a click to its route, and from an image to the stage."""
    followed, ways = Followed(), dict[str, Way]()
    program = Program(followed)
    try:
        for _ in range(2):
            program.next()
            with followed.noted():
                program.next()
            (ways["image to stage"],) = followed.ways
        for experience in (0, 5):
            program.next()
            with followed.noted():
                program.click(experience)
            (ways["click to route"],) = followed.ways
    finally:
        program.close()
    ways["of these, what no tick without a click enters"] = {
        file: None for file in ways["click to route"] if file not in ways["image to stage"]
    }
    return ways


# ------------------------------------------------------------ an experiment


def experiment_ways(folder: Path) -> dict[str, Way]:
    """`ratslam experiment table`, on a worker that is a thread of this process, so that it can be followed."""
    followed = Followed(Session.__init__.__code__, Session.tick.__code__)
    threading.setprofile(followed)  # of all threads that begin from now on
    cluster: Any = LocalCluster(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None)  # pyright: ignore[reportArgumentType]
    try:
        _experiment(cluster, folder / "first")
        with followed.noted():
            _experiment(cluster, folder / "again")
    finally:
        cluster.close()
        threading.setprofile(None)
    return dict(zip(TABLE_WAYS, followed.ways, strict=True))


def _experiment(cluster: Any, folder: Path) -> None:
    places = "--store", str(folder / "trials.sqlite"), "--out", str(folder)
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        code = command([*EXPERIMENT, "--scheduler", cluster.scheduler_address, *places])
    assert code == 0, said.getvalue()


# ------------------------------------------------------------ files, lines, imports


def code_files(root: Path, room: str) -> list[Path]:
    """Python and JavaScript, without what others wrote."""
    found = (path for kind in ("*.py", "*.js") for path in (root / room).rglob(kind))
    return sorted(path for path in found if not {"vendor", "node_modules"} & set(path.parts))


def modules(root: Path, rooms: tuple[str, ...] = ROOMS) -> dict[str, Path]:
    """Python files by the names by which they are imported."""
    paths = (path for room in rooms for path in code_files(root, room) if path.suffix == ".py")
    return {".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path for path in paths}


def importers(known: dict[str, Path]) -> dict[str, set[str]]:
    """Who imports each file, anywhere. A name taken from a package's face is imported from where the face has it."""
    faces: dict[tuple[str, str], str] = {}
    for package, path in known.items():
        if path.name == "__init__.py":
            for face in (path, path.with_suffix(".pyi")):
                if face.exists():
                    faces |= {(package, name): _target(known, module, name) for module, name in _imports(face, package)}
    found: dict[str, set[str]] = {name: set() for name in known}
    for name, path in known.items():
        for module, what in _imports(path, name):
            target = faces.get((module, what)) or _target(known, module, what)
            if target in found and target != name:
                found[target].add(name)
    return found


def circles(known: dict[str, Path]) -> set[frozenset[str]]:
    """Files that load one another while they are loaded."""
    loads = {
        name: {_target(known, *each) for each in _imports(path, name, at_once=True)} & known.keys() - {name}
        for name, path in known.items()
    }
    reached = {name: _reached(name, loads) for name in known}
    return {frozenset(b for b in reached[a] if a in reached[b]) for a in known if a in reached[a]}


def _reached(name: str, loads: dict[str, set[str]]) -> set[str]:
    found, waiting = set[str](), [name]
    while waiting:
        new = loads[waiting.pop()] - found
        found |= new
        waiting += new
    return found


def _target(known: dict[str, Path], module: str, name: str) -> str:
    """The file that `from module import name` means."""
    inside = f"{module}.{name}"
    return inside if inside in known else module


def _imports(path: Path, module: str, at_once: bool = False) -> Iterator[tuple[str, str]]:
    """What a file imports: module and name. at_once: without what is imported in functions, and for types alone."""
    package = module.split(".") if path.stem == "__init__" else module.split(".")[:-1]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in _loaded(tree) if at_once else ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*above, *filter(None, [node.module])])
            yield from ((origin, alias.name) for alias in node.names)


def _loaded(node: ast.AST) -> Iterator[ast.AST]:
    """What runs when a file is loaded."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            continue
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        yield child
        yield from _loaded(child)


def script_importers(root: Path) -> dict[Path, set[Path]]:
    """The same of the page's modules."""
    scripts = [path for path in code_files(root, "web") if path.suffix == ".js"]
    found: dict[Path, set[Path]] = {path: set() for path in scripts}
    for path in scripts:
        for name in re.findall(r"""(?:from|import)\s*\(?["'](\.[^"']+)["']""", path.read_text(encoding="utf-8")):
            target = (path.parent / name).resolve()
            if target in found and target != path:
                found[target].add(path)
    return found


def spread(root: Path) -> dict[str, Counter[str]]:
    """Files and lines by folder, of each room and of all."""
    rows: dict[str, Counter[str]] = defaultdict(Counter)
    for room in (*ROOMS, *BESIDE):
        for path in code_files(root, room):
            whole = f"{room}, all"
            folders = (path.parent.relative_to(root).as_posix(), whole, "rooms, all") if room in ROOMS else (whole,)
            for folder in folders:
                rows[folder] += Counter({path.suffix: 1, f"{path.suffix} lines": _lines(path)})
    return dict(sorted(rows.items()))


def house(root: Path) -> dict[str, Any]:
    """Figures of all files of a tree."""
    known, rows = modules(root), spread(root)
    sizes = {folder: _entries(root / folder) for folder in rows if not folder.endswith(", all")}
    alone = [name for name, whose in importers(known).items() if len(whose) == 1 and known[name].stem != "__init__"]
    scripts = [path for path, whose in script_importers(root).items() if len(whose) == 1]
    return {
        "folders": rows,
        "one importer": alone,
        "one importer, scripts": [path.relative_to(root).as_posix() for path in scripts],
        "large folders": {folder: size for folder, size in sizes.items() if size > MOST_FILES},
        "small folders": {folder: size for folder, size in sizes.items() if size < LEAST_FILES},
        "circles": [sorted(circle) for circle in circles(known)],
        "longest file": max((_lines(path), path.relative_to(root).as_posix()) for path in known.values()),
        "longest function": max(
            ((node.end_lineno or 0) - node.lineno + 1, f"{name}: {node.name}")
            for name, path in known.items()
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        ),
    }


def _entries(folder: Path) -> int:
    """Files of code in a folder; on the page what is shown has its styles beside its script."""
    return sum(path.suffix in (".py", ".js", ".css", ".html", ".j2") for path in folder.iterdir())


def _lines(path: Path) -> int:
    return path.read_bytes().count(b"\n")


# ------------------------------------------------------------ told


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--only", choices=("engine", "experiment", "house"), help="two ways, the third, or files")
    parser.add_argument("--json", type=Path, metavar="OUT", help="also write all figures and lists to OUT")
    options = parser.parse_args()
    ways = dict[str, Way]()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["RATSLAM_RUNS"] = str(Path(folder) / "runs")
        if options.only in (None, "engine"):
            ways |= engine_ways()
        if options.only in (None, "experiment"):
            ways |= experiment_ways(Path(folder))
    for name, way in ways.items():
        _tell_way(name, list(way))
    told: dict[str, Any] = {"ways": {name: list(way) for name, way in ways.items()}}
    if options.only in (None, "house"):
        told["house"] = house(ROOT)
        _tell_house(told["house"])
    if options.json is not None:
        write_whole(options.json, orjson.dumps(told, option=orjson.OPT_INDENT_2).decode())
    return 0


def _tell_way(name: str, files: list[str]) -> None:
    bar = BARS.get(name)
    judged = "" if bar is None else f", bar {bar}: {'met' if len(files) <= bar else 'MISSED'}"
    print(f"\n{name}: {len(files)} files{judged}")
    rooms: dict[str, list[str]] = defaultdict(list)
    for file in files:
        room, inside = file.split("/", 1)
        rooms[room].append(inside)
    for room, inside in rooms.items():
        print(
            textwrap.fill(
                f"{room} ({len(inside)}): {' '.join(inside)}", 130, initial_indent="  ", subsequent_indent="    "
            )
        )


def _tell_house(found: dict[str, Any]) -> None:
    print(f"\n{'folder':34} Python   lines  scripts  lines")
    for folder, row in found["folders"].items():
        python, scripts = f"{row['.py']:6} {row['.py lines']:7,}", f"{row['.js']:8} {row['.js lines']:6,}"
        print(f"{folder:34} {python if row['.py'] else '':14} {scripts if row['.js'] else ''}".rstrip())
    print(
        f"files with one importer: {len(found['one importer'])} of Python, {len(found['one importer, scripts'])} scripts"
    )
    for words in ("large folders", "small folders"):
        print(f"{words}: {len(found[words])}  {', '.join(f'{folder} {size}' for folder, size in found[words].items())}")
    print(f"circles of imports: {len(found['circles'])}  {found['circles'] or ''}".rstrip())
    for words in ("longest file", "longest function"):
        print("{}: {} lines, {}".format(words, *found[words]))


if __name__ == "__main__":
    raise SystemExit(main())

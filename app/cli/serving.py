"""How the dashboard of `ratslam run` is served, from the first compiling to the last stop."""

from __future__ import annotations

import gc
import os
import sys
import threading
import webbrowser
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from app.run_record.folder import BUDGET_MB, runs_folder

if TYPE_CHECKING:
    from app.cli.beginnings import First
    from app.run_record.keyframes import PastRoom
    from app.startup.compiling import Compiling
    from web.http.class_door import Classroom
    from web.http.server import Dashboard, ForClass

PAST_MB, PAST_DISK_MB = 200.0, 2000.0
ENGINE_PATIENCE_S = 2.0  # how long leaving waits for a tick that hangs


@dataclass(frozen=True, slots=True)
class Serving:
    """How the dashboard is served. speed: simulated seconds per second, 0 = as fast as possible."""

    port: int = 8000
    browser: bool = True  # open the page where there is a screen
    speed: float = 1.0
    running: bool = True
    keep_mb: float = BUDGET_MB  # room for runs that are kept
    past_mb: float = PAST_MB  # memory for looking back ...
    past_disk_mb: float = PAST_DISK_MB  # ... and room on the disk for what it does not hold
    for_class: ForClass | None = None  # where a class votes and looks on


def serve(serving: Serving, first: First) -> int:
    """Serve it until it is stopped. The exit code. ValueError says why it cannot be."""
    from app.startup.compiling import Compiling

    compiling = Compiling()  # runs in the background while the rest is loaded
    try:
        return _serve(serving, first, compiling)
    finally:
        compiling.stop()


def _past_room(serving: Serving) -> PastRoom:
    from app.run_record.keyframes import PastRoom

    try:
        folder = runs_folder()
    except ValueError:  # no home directory
        folder = None
    return PastRoom(round(1e6 * serving.past_mb), round(1e6 * serving.past_disk_mb), folder)


def _serve(serving: Serving, first: First, compiling: Compiling) -> int:
    from app.cli.beginnings import going_on
    from app.engine_thread import EngineThread
    from app.export.page import PageExports
    from app.gallery.gallery import StoredGallery
    from app.gallery.lessons import StoredLessons
    from app.run_record.link import PageSituations
    from app.run_record.writer import RunKeeper
    from app.session_snapshot import load_its_brain
    from app.startup.waking import Waking
    from web import messages as m
    from web.http.brains import Offered
    from web.http.server import CannotListen, Dashboard
    from web.viewer.viewer import Viewers

    gc.freeze()  # what is loaded by now stays to the end: to look through it for garbage holds everything up for 50 ms

    def warn(words: str) -> None:
        print(f"ratslam: {words}", file=sys.stderr, flush=True)
        engine.submit(m.Warn(words))

    runs = RunKeeper(warn, serving.keep_mb) if serving.keep_mb > 0 else None
    engine = EngineThread(
        first.world, first.seed, first.config, speed=serving.speed, running=serving.running, brain=first.brain,
        first=first.begin, keeper=runs, past_room=_past_room(serving),
    )  # fmt: skip
    viewers = Viewers(engine.latest, engine.submit)
    kept, cut_off = first.kept, first.cut_off
    offered = kept and Offered(**asdict(kept.about), read=partial(load_its_brain, kept.path))
    if cut_off is not None:
        offered = Offered(
            cut_off.header.world_name, cut_off.header.seed, cut_off.length_s, cut_off.experiences or 0, cut_off.left_at,
            run=cut_off.name, go_on=partial(going_on, cut_off),
        )  # fmt: skip
    dashboard = Dashboard(
        engine.latest, engine.submit, viewers, port=serving.port, offered=offered, experiments=StoredGallery(),
        exports=PageExports(lambda: runs and runs.folder),
        opener=_opened, situations=PageSituations(), lessons=StoredLessons(), for_class=serving.for_class,
    )  # fmt: skip
    try:
        dashboard.bind()
    except CannotListen as error:
        raise ValueError(str(error)) from None

    waking = Waking(engine, compiling)
    dashboard.on_ready, engine.on_stillborn = partial(_tell, serving, dashboard), dashboard.stop
    waking.start()
    if runs is not None:
        runs.start()
    try:
        dashboard.run()
    finally:
        waking.stop(ENGINE_PATIENCE_S)
        if runs is not None:
            runs.stop()
    if engine.stillborn is not None:
        raise ValueError(f"the engine could not begin: {engine.stillborn}")
    return 0


def _opened(path: Path, called_off: threading.Event) -> object:
    """What plays the recording in a file. ValueError says what is wrong with it."""
    from app.recordings.apart import ReadApart
    from app.recordings.playing import Player

    return Player(ReadApart(path, called_off=called_off), 1, path=path)


def _tell(serving: Serving, dashboard: Dashboard, url: str) -> None:
    if dashboard.classroom is not None:
        print(class_words(dashboard.classroom), flush=True)
    print(f"RatSLAM is alive at {url}  (Ctrl+C ends it)", flush=True)
    if serving.browser and _has_screen():
        webbrowser.open(url)


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def class_words(classroom: Classroom) -> str:
    return (
        f"A class votes at {classroom.url} and looks on at {classroom.url}?watch, as can whoever is in the same network"
    )

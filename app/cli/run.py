"""`ratslam run`: the dashboard, and how it is served, from the first compiling to the last stop. With `--class`, a class
in the local network is let in.
"""

from __future__ import annotations

import argparse
import gc
import math
import os
import sys
import threading
import webbrowser
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.options import ENGINES, Verbs, add_session_options, port_number
from app.run_record.folder import BUDGET_MB, runs_folder

if TYPE_CHECKING:
    from app.cli.beginnings import First
    from app.protocol.trial import Trial
    from app.run_record.keyframes import PastRoom
    from app.startup.compiling import Compiling
    from web.http.class_door import Classroom
    from web.http.server import Dashboard, ForClass


CLASS_PORT = 8001
LEAST_PAST_MB = 20.0  # the copy of the last moment alone takes some


def add_run(commands: Verbs) -> None:
    run = commands.add_parser("run", help="open the dashboard (this is what `ratslam` alone does)")
    add_session_options(run)
    run.add_argument(
        "--port", type=port_number, default=8000, help="port on 127.0.0.1; 0 = any free one (default 8000)"
    )
    _add_class_options(run)
    run.add_argument("--no-browser", action="store_true", help="only print the address")
    run.add_argument("--paused", action="store_true", help="start paused")
    run.add_argument(
        "--speed", type=float, default=1.0, help="simulated seconds per second, 0.25 to 16; 0 = as fast as possible"
    )
    run.add_argument(
        "--resume-brain", action="store_true", help="go on with the brain kept last, in its world and with its seed"
    )
    run.add_argument(
        "--resume", metavar="ID", help="go on with a run that was kept, as `ratslam runs` lists it, or `last`"
    )
    run.add_argument(
        "--situation", metavar="FILE|LINK", help="play up to the moment of a situation: its file, or its link in quotes"
    )
    run.add_argument(
        "--keep-runs", type=float, default=BUDGET_MB, metavar="MB",
        help=f"room for the runs that are kept; the oldest are deleted first (default {BUDGET_MB:g}, 0 = none, and no brain)",
    )  # fmt: skip
    run.add_argument(
        "--keep-past", type=float, default=PAST_MB, metavar="MB",
        help=f"memory for going back in time (default {PAST_MB:g}, at least {LEAST_PAST_MB:g})",
    )  # fmt: skip
    run.add_argument(
        "--keep-past-disk", type=float, default=PAST_DISK_MB, metavar="MB",
        help=f"room on the disk for what that memory does not hold; when both are full, what is older is kept at fewer "
        f"moments, and going there takes longer (default {PAST_DISK_MB:g}, 0 = none)",
    )  # fmt: skip
    run.add_argument(
        "--recording", type=Path, metavar="PATH", help="play a recording of a robot: MCAP, bag, video, pictures, ..."
    )
    run.add_argument("--experiment", metavar="NAME|FILE", help="watch a trial of this experiment (--seed: this one)")
    run.add_argument("--engine", choices=ENGINES, help="with --experiment: our rules or the paper's")
    run.add_argument("--levels", nargs="+", metavar="LEVEL", help="with --experiment: one level of each of its axes")
    run.set_defaults(do=_run, seed=None)


def _add_class_options(run: argparse.ArgumentParser) -> None:
    run.add_argument(
        "--class", dest="for_class", action="store_true", help="a class in the local network votes and looks on"
    )
    run.add_argument("--class-address", metavar="ADDRESS", help="with --class: at this address of the machine")
    run.add_argument(
        "--class-port", type=int, metavar="PORT", help=f"with --class: port (default {CLASS_PORT}, 0 = any free one)"
    )


def _run(args: argparse.Namespace) -> int:
    from web.messages.commands import SPEEDS, is_speed

    if not is_speed(args.speed):
        raise ValueError(f"--speed must be {SPEEDS}, got {args.speed:g}")
    if not args.keep_runs >= 0:
        raise ValueError(f"--keep-runs must be megabytes from 0 on, got {args.keep_runs:g}")
    if not LEAST_PAST_MB <= args.keep_past < math.inf:
        raise ValueError(f"--keep-past must be megabytes from {LEAST_PAST_MB:g} on, got {args.keep_past:g}")
    if not 0 <= args.keep_past_disk < math.inf:
        raise ValueError(f"--keep-past-disk must be megabytes from 0 on, got {args.keep_past_disk:g}")
    serving = Serving(
        args.port, not args.no_browser, args.speed, not args.paused, args.keep_runs, args.keep_past,
        args.keep_past_disk, _for_class(args),
    )  # fmt: skip
    return serve(serving, _first(args, serving))


def _for_class(args: argparse.Namespace) -> ForClass | None:
    """Where a class is let in. ValueError: an option says where, but not that."""
    if args.for_class:
        from web.http.server import ForClass

        return ForClass(args.class_address, CLASS_PORT if args.class_port is None else args.class_port)
    for name in ("class-address", "class-port"):
        if getattr(args, name.replace("-", "_")) is not None:
            raise ValueError(f"--{name} goes with --class, which lets a class in")
    return None


def _first(args: argparse.Namespace, serving: Serving) -> First:
    from app.cli.beginnings import chosen_experiment, new_run, opened_situation, played_recording, resumed_run

    if args.resume is not None:
        return resumed_run(args)
    if args.situation is not None:
        return opened_situation(args)
    if args.recording is not None:
        return played_recording(args)
    if args.experiment is not None:
        return chosen_experiment(args, serving.running)
    return new_run(args)


def run_with_trial(trial: Trial, moment_s: float | None, *, title: str = "", serving: Serving | None = None) -> int:
    """Open the dashboard on a trial of an experiment. The exit code.

    moment_s: simulated time of the moment that is to be seen: the trial is run ahead, as fast as possible, to shortly
    before it, and plays from there. None: it plays from its beginning. title: of the experiment, by default as in the
    catalogue.
    """
    from app.cli.beginnings import first_of_trial
    from app.protocol.experiment import catalogue

    title = title or next((each.title for each in catalogue() if each.name == trial.experiment), trial.experiment)
    serving = serving or Serving()
    return serve(serving, first_of_trial(trial, moment_s, title, serving.running))


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
    from app.export.export import PageExports
    from app.gallery import StoredGallery, StoredLessons
    from app.run_record.link import PageSituations
    from app.run_record.writer import RunKeeper
    from app.session_snapshot import load_its_brain
    from app.startup.compiling import EngineStarter
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

    starter = EngineStarter(engine, compiling)
    dashboard.on_ready, engine.on_startup_error = partial(_announce, serving, dashboard), dashboard.stop
    starter.start()
    if runs is not None:
        runs.start()
    try:
        dashboard.run()
    finally:
        starter.stop(ENGINE_PATIENCE_S)
        if runs is not None:
            runs.stop()
    if engine.startup_error is not None:
        raise ValueError(f"the engine could not begin: {engine.startup_error}")
    return 0


def _opened(path: Path, called_off: threading.Event) -> object:
    """What plays the recording in a file. ValueError says what is wrong with it."""
    from app.recordings.playing import Player
    from app.recordings.reader_process import ReaderProcess

    return Player(ReaderProcess(path, called_off=called_off), 1, path=path)


def _announce(serving: Serving, dashboard: Dashboard, url: str) -> None:
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

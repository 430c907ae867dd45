"""`ratslam run`: the dashboard."""

from __future__ import annotations

import argparse
import math
import os
import sys
import webbrowser
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.earlier import cut_off_run, going_on, kept_brain
from app.cli.for_class import add_class_options, class_words, for_class
from app.cli.options import Verbs, add_session_options, checked_seed, config_of, session_of
from app.config import Config
from app.order_book import SMALLEST_M
from app.runs.folder import BUDGET_MB
from app.startup.compiling import Compiling
from app.startup.waking import Waking
from ratslam_core import RatSlam, load_brain
from sim2d import DEFAULT_WORLD, World, own_worlds, world_from_json
from sim2d.importers import open_world

if TYPE_CHECKING:
    from app.engine.engine import Engine
    from app.kept_brains.files import KeptBrain
    from app.runs.run_file import KeptRun
    from app.trials.trial import Trial
    from web.http.server import Dashboard, ForClass

PAST_MB, LEAST_PAST_MB = 200.0, 20.0  # the copy of the last moment alone takes some
ENGINE_PATIENCE_S = 2.0  # how long leaving waits for a tick that hangs
_NOT_WITH_RECORDING = ("scale", "brain", "resume_brain", "experiment", "engine", "levels")
_NOT_WITH_EXPERIMENT = ("scale", "brain", "preset", "config", "set", "resume_brain")


@dataclass(frozen=True, slots=True)
class Serving:
    """How the dashboard is served. speed: simulated seconds per second, 0 = as fast as possible."""

    port: int = 8000
    browser: bool = True  # open the page where there is a screen
    speed: float = 1.0
    running: bool = True
    keep_mb: float = BUDGET_MB  # room for runs that are kept
    past_mb: float = PAST_MB  # memory for looking back
    for_class: ForClass | None = None  # where a class votes and looks on


@dataclass(frozen=True, slots=True)
class First:
    """What the session begins with. begin: begins the first run otherwise."""

    world: World
    seed: int
    config: Config
    brain: RatSlam | None = None
    begin: Callable[[Engine], object] | None = None


def add_run(commands: Verbs) -> None:
    run = commands.add_parser("run", help="open the dashboard (this is what `ratslam` alone does)")
    add_session_options(run)
    run.add_argument("--port", type=_port, default=8000, help="port on 127.0.0.1; 0 = any free one (default 8000)")
    add_class_options(run)
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
        help=f"room for the runs that are kept; the oldest are deleted first (default {BUDGET_MB:g}, 0 = keep none)",
    )  # fmt: skip
    run.add_argument(
        "--keep-past", type=float, default=PAST_MB, metavar="MB",
        help=f"memory for going back in time; when it is full, what is older is kept at fewer moments, and going there "
        f"takes longer (default {PAST_MB:g}, at least {LEAST_PAST_MB:g})",
    )  # fmt: skip
    run.add_argument(
        "--recording", type=Path, metavar="PATH", help="play a recording of a robot: MCAP, bag, video, pictures, ..."
    )
    run.add_argument("--experiment", metavar="NAME|FILE", help="watch a trial of this experiment (--seed: this one)")
    run.add_argument("--engine", choices=("ours", "paper"), help="with --experiment: our rules or the paper's")
    run.add_argument("--levels", nargs="+", metavar="LEVEL", help="with --experiment: one level of each of its axes")
    run.set_defaults(do=_run, seed=None)


def _port(text: str) -> int:
    port = int(text) if text.isdigit() else -1
    if not 0 <= port <= 65535:
        raise argparse.ArgumentTypeError(f"a port is a whole number from 0 to 65535, got {text!r}")
    return port


def _run(args: argparse.Namespace) -> int:
    from web.messages.commands import SPEEDS, is_speed

    if not is_speed(args.speed):
        raise ValueError(f"--speed must be {SPEEDS}, got {args.speed:g}")
    if not args.keep_runs >= 0:
        raise ValueError(f"--keep-runs must be megabytes from 0 on, got {args.keep_runs:g}")
    if not LEAST_PAST_MB <= args.keep_past < math.inf:
        raise ValueError(f"--keep-past must be megabytes from {LEAST_PAST_MB:g} on, got {args.keep_past:g}")
    serving = Serving(
        args.port, not args.no_browser, args.speed, not args.paused, args.keep_runs, args.keep_past, for_class(args)
    )
    if args.resume is not None:
        return _resume_run(args, serving)
    if args.situation is not None:
        return _run_situation(args, serving)
    if args.recording is not None:
        return _run_recording(args, serving)
    if args.experiment is not None:
        return _run_experiment(args, serving)
    for name in ("engine", "levels"):
        if getattr(args, name) is not None:
            raise ValueError(f"--{name} is for a trial; give --experiment NAME with it")
    args.seed = 1 if args.seed is None else args.seed
    own_worlds.tidy()
    kept = kept_brain(args)
    cut_off = None if args.resume_brain or args.brain is not None else cut_off_run()
    world, config, brain = session_of(args)
    return _compiling(
        lambda compiling: _serve(serving, First(world, args.seed, config, brain), compiling, kept, cut_off)
    )


def _resume_run(args: argparse.Namespace, serving: Serving) -> int:
    """Go on with a run where it was left; what led there is run again first."""
    from app.cli.progress import compile_first, with_progress
    from app.runs.folder import is_open
    from app.runs.replay import resumed
    from app.runs.run_file import open_run

    for name in ("seed", "recording", *_NOT_WITH_EXPERIMENT, "experiment", "engine", "levels"):
        if getattr(args, name):
            raise ValueError(f"--{name.replace('_', '-')} does not go with --resume: the run has its own")
    if args.world != DEFAULT_WORLD:
        raise ValueError(f"--world {args.world} does not go with --resume: the run has its own world")
    kept = open_run(args.resume)
    if is_open(kept.folder):
        raise ValueError(f"the run {kept.name} is going on in another program")
    compile_first()
    session = with_progress(
        kept.length_s, lambda tell: resumed(kept, lambda s: tell(s, "running again what led there"))
    )
    print(f"The run {kept.name} goes on at tick {session.tick_count}", flush=True)
    own_worlds.tidy()
    world = open_world(DEFAULT_WORLD) if session.recording is not None else session.world
    first = First(world, session.seed, session.config, begin=lambda engine: engine.go_on(kept, session))
    return _compiling(lambda compiling: _serve(serving, first, compiling, None))


def _run_situation(args: argparse.Namespace, serving: Serving) -> int:
    """Play up to the moment of a situation; the page shows how far it is."""
    from app.cli.situation import situation_in

    for name in ("seed", "recording", *_NOT_WITH_EXPERIMENT, "experiment", "engine", "levels"):
        if getattr(args, name):
            raise ValueError(f"--{name.replace('_', '-')} does not go with --situation, which has its own")
    if args.world != DEFAULT_WORLD:
        raise ValueError(f"--world {args.world} does not go with --situation, which has its own world")
    situation = situation_in(args.situation)
    header = situation.header
    own_worlds.tidy()
    world = world_from_json(header.world, f"the world {header.world_name}", SMALLEST_M)
    first = First(world, header.seed, header.config, begin=lambda engine: engine.open_situation(situation))
    return _compiling(lambda compiling: _serve(serving, first, compiling, None))


def _run_recording(args: argparse.Namespace, serving: Serving) -> int:
    from app.recordings.opening import open_recording
    from app.recordings.playing import Player

    for name in _NOT_WITH_RECORDING:
        if getattr(args, name):
            raise ValueError(f"--{name.replace('_', '-')} does not go with --recording, which is no simulated world")
    if args.world != DEFAULT_WORLD:
        raise ValueError(f"--world {args.world} does not go with --recording, which is no simulated world")
    seed = checked_seed(1 if args.seed is None else args.seed)
    player = Player(open_recording(args.recording), seed, path=args.recording)
    player.config = config_of(args, player.config)

    def begin(engine: Engine) -> None:
        engine.begin_recording(player)

    own_worlds.tidy()
    first = First(open_world(DEFAULT_WORLD), seed, player.config, begin=begin)
    return _compiling(lambda compiling: _serve(serving, first, compiling, None))


def _run_experiment(args: argparse.Namespace, serving: Serving) -> int:
    from app.trials.chosen import chosen_trial
    from app.trials.experiment import find_experiment

    for name in _NOT_WITH_EXPERIMENT:
        if getattr(args, name):
            raise ValueError(
                f"--{name.replace('_', '-')} does not go with --experiment, which has its own world and parameters"
            )
    if args.world != DEFAULT_WORLD:
        raise ValueError(f"--world {args.world} does not go with --experiment, which has its own world and parameters")
    experiment = find_experiment(args.experiment)
    trial = chosen_trial(experiment, args.engine, args.levels, args.seed)
    return run_with_trial(trial, None, title=experiment.title, serving=serving)


def run_with_trial(trial: Trial, moment_s: float | None, *, title: str = "", serving: Serving | None = None) -> int:
    """Open the dashboard on a trial of an experiment. The exit code.

    moment_s: simulated time of the moment that is to be seen: the trial is run ahead, as fast as possible, to shortly
    before it, and plays from there. None: it plays from its beginning. title: of the experiment, by default as in the
    catalogue.
    """
    from app.engine.watched_trial import CHANGED
    from app.trials.code_version import code_version
    from app.trials.experiment import catalogue

    title = title or next((each.title for each in catalogue() if each.name == trial.experiment), trial.experiment)

    serving = serving or Serving()
    config = Config().with_values(trial.values)
    world = open_world(trial.world, robot_radius_m=config.robot.robot_radius_m)

    def begin(engine: Engine) -> None:
        run = engine.begin_trial(trial, title, moment_s)
        if trial.version != code_version():
            run.event_log.note("warning", CHANGED)
        engine.running = serving.running or engine.runs_ahead

    own_worlds.tidy()
    first = First(world, trial.seed, config, begin=begin)
    return _compiling(lambda compiling: _serve(serving, first, compiling, None))


def _compiling(serve: Callable[[Compiling], int]) -> int:
    compiling = Compiling()  # runs in the background while the rest is loaded
    try:
        return serve(compiling)
    finally:
        compiling.stop()


def _opened(path: Path) -> object:
    """What plays the recording in a file. ValueError says what is wrong with it."""
    from app.recordings.opening import open_recording
    from app.recordings.playing import Player

    return Player(open_recording(path), 1, path=path)


def _serve(
    serving: Serving, first: First, compiling: Compiling, kept: KeptBrain | None, cut_off: KeptRun | None = None
) -> int:
    from app.engine_thread import EngineThread
    from app.export.page import PageExports
    from app.gallery.gallery import StoredGallery
    from app.gallery.lessons import StoredLessons
    from app.kept_brains.keeper import BrainKeeper
    from app.runs.keeper import RunKeeper
    from app.situations.page import PageSituations
    from web import messages as m
    from web.http.kept_offer import Offered
    from web.http.server import CannotListen, Dashboard
    from web.viewer.viewers import Viewers

    def warn(words: str) -> None:
        print(f"ratslam: {words}", file=sys.stderr, flush=True)
        engine.submit(m.Warn(words))

    runs = RunKeeper(warn, serving.keep_mb) if serving.keep_mb > 0 else None
    engine = EngineThread(
        first.world, first.seed, first.config, speed=serving.speed, running=serving.running, brain=first.brain,
        first=first.begin, keeper=runs, keyframe_bytes=round(1e6 * serving.past_mb),
    )  # fmt: skip
    viewers = Viewers(engine.latest, engine.submit)
    offered = kept and Offered(**asdict(kept.about), read=partial(load_brain, kept.path))
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

    waking, keeper = Waking(engine, compiling), BrainKeeper(engine.latest, engine.submit)
    dashboard.on_ready, engine.on_stillborn = partial(_tell, serving, dashboard), dashboard.stop
    waking.start()
    keeper.start()
    if runs is not None:
        runs.start()
    try:
        dashboard.run()
    finally:
        keeper.stop()
        waking.stop(ENGINE_PATIENCE_S)
        if runs is not None:
            runs.stop()
    if engine.stillborn is not None:
        raise ValueError(f"the engine could not begin: {engine.stillborn}")
    return 0


def _tell(serving: Serving, dashboard: Dashboard, url: str) -> None:
    if dashboard.classroom is not None:
        print(class_words(dashboard.classroom), flush=True)
    print(f"RatSLAM is alive at {url}  (Ctrl+C ends it)", flush=True)
    if serving.browser and _has_screen():
        webbrowser.open(url)


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))

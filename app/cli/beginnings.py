"""What `ratslam run` begins with: a run of its own, one that was kept, a situation, a recording, a trial.

What earlier programs left, a brain that was kept or a run that was cut off, is offered to be gone on with.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.options import checked_seed, config_of, session_of
from app.config import Config
from app.orders import SMALLEST_M
from app.run_record.link import KEY, read_situation
from app.run_record.situation import Situation
from disk import user_folder
from disk.limits import SITUATION_BYTES
from ratslam_core import RatSlam
from sim2d import DEFAULT_WORLD, World, own_worlds, world_from_json
from sim2d.importers import open_world

if TYPE_CHECKING:
    from app.engine.engine import Engine
    from app.protocol.trial import Trial
    from app.run_record.reader import KeptRun
    from app.run_record.states import KeptBrain
    from web import messages as m

_NOT_WITH_RECORDING = ("scale", "brain", "resume_brain", "experiment", "engine", "levels")
_NOT_WITH_EXPERIMENT = ("scale", "brain", "preset", "config", "set", "resume_brain")
_NOT_WITH_A_RUN = ("seed", "recording", *_NOT_WITH_EXPERIMENT, "experiment", "engine", "levels")


@dataclass(frozen=True, slots=True)
class First:
    """What the session begins with. begin: begins the first run otherwise. kept, cut_off: what earlier programs left, to be
    offered on the page."""

    world: World
    seed: int
    config: Config
    brain: RatSlam | None = None
    begin: Callable[[Engine], object] | None = None
    kept: KeptBrain | None = None
    cut_off: KeptRun | None = None


def new_run(args: argparse.Namespace) -> First:
    """A run of its own: of a world, with a new brain or one that was kept."""
    for name in ("engine", "levels"):
        if getattr(args, name) is not None:
            raise ValueError(f"--{name} is for a trial; give --experiment NAME with it")
    args.seed = 1 if args.seed is None else args.seed
    own_worlds.tidy()
    kept = _kept_brain(args)
    cut_off = None if args.resume_brain or args.brain is not None else cut_off_run()
    world, config, brain = session_of(args)
    return First(world, args.seed, config, brain, kept=kept, cut_off=cut_off)


def _kept_brain(args: argparse.Namespace) -> KeptBrain | None:
    """The brain kept last: with --resume-brain set up to be run, without it returned, to be offered on the page."""
    from app.run_record.folder import runs_folder
    from app.run_record.states import newest_brain

    kept = newest_brain()
    if not args.resume_brain:
        if kept is None or args.brain is not None:
            return None
        print(f"There is {kept.words}: go on with it by `ratslam run --resume-brain`", flush=True)
        return kept
    if args.brain is not None:
        raise ValueError(f"--resume-brain takes the brain that was kept last; do not give --brain {args.brain} with it")
    if kept is None:
        raise ValueError(f"--resume-brain: no brain is kept in {runs_folder()}{_of_before()}")
    args.brain, args.world, args.seed = kept.path, kept.about.world, kept.about.seed
    return None


def _of_before() -> str:
    """Earlier programs kept brains in a folder of their own."""
    folder = user_folder("brains")
    return f"; those of an earlier version are in {folder}: --brain FILE takes one" if folder.exists() else ""


def cut_off_run() -> KeptRun | None:
    """The newest run, if it was cut off in the middle, by a crash or a kill."""
    from app.run_record.folder import all_runs, is_open
    from app.run_record.reader import open_run

    for folder in all_runs()[:1]:
        try:
            run = open_run(folder)
        except ValueError:
            return None
        if run.tick > 0 and not run.end and not is_open(folder):
            print(f"The run {run.name} was cut off: go on with it by `ratslam run --resume {run.name}`", flush=True)
            return run
    return None


def going_on(kept: KeptRun, progress: Callable[[float], object]) -> m.GoOn:
    """The run in the session where it was left. progress: is called with the share that is done, and may raise to give it up."""
    from app.run_record.resume import resumed
    from web import messages as m

    done_s = 0.0

    def passed(seconds: float) -> None:
        nonlocal done_s
        done_s += seconds
        progress(min(1.0, done_s / max(kept.length_s, 1e-9)))

    return m.GoOn(kept, resumed(kept, passed))


def resumed_run(args: argparse.Namespace) -> First:
    """Go on with a run where it was left; what led there is run again first."""
    from app.cli.options import compile_first, with_progress
    from app.run_record.folder import busy_words, is_open
    from app.run_record.reader import open_run
    from app.run_record.resume import resumed

    _refuse(args, _NOT_WITH_A_RUN, "--resume: the run has its own")
    kept = open_run(args.resume)
    if is_open(kept.folder):
        raise ValueError(f"the run {kept.name} {busy_words(kept.folder)}")
    compile_first()
    session = with_progress(
        kept.length_s, lambda progress: resumed(kept, lambda s: progress(s, "running again what led there"))
    )
    print(f"The run {kept.name} goes on at tick {session.tick_count}", flush=True)
    own_worlds.tidy()
    world = session.source.world or open_world(DEFAULT_WORLD)
    return First(world, session.seed, session.config, begin=lambda engine: engine.go_on(kept, session))


def opened_situation(args: argparse.Namespace) -> First:
    """Play up to the moment of a situation; the page shows how far it is."""
    _refuse(args, _NOT_WITH_A_RUN, "--situation, which has its own")
    situation = _situation_in(args.situation)
    header = situation.header
    own_worlds.tidy()
    world = world_from_json(header.world, f"the world {header.world_name}", SMALLEST_M)
    return First(world, header.seed, header.config, begin=lambda engine: engine.open_situation(situation))


def _situation_in(name: str) -> Situation:
    """The situation in a file, or of a link. ValueError says why it cannot be opened."""
    if f"{KEY}=" in name:
        return read_situation(name)
    try:
        with Path(name).open("rb") as file:
            text = file.read(SITUATION_BYTES + 1).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise ValueError(
            f"--situation {name[:80]}: {reason}; give the file of a situation, or a link with #{KEY}= in quotes"
        ) from None
    try:
        return read_situation(text)
    except ValueError as error:
        raise ValueError(f"--situation {name[:80]}: {error}") from None


def played_recording(args: argparse.Namespace) -> First:
    """A recording from its beginning."""
    from app.recordings.playing import Player
    from app.recordings.reader_process import ReaderProcess

    _refuse(args, _NOT_WITH_RECORDING, "--recording, which is no simulated world")
    seed = checked_seed(1 if args.seed is None else args.seed)
    player = Player(ReaderProcess(args.recording), seed, path=args.recording)
    player.config = config_of(args, player.config)
    own_worlds.tidy()
    return First(open_world(DEFAULT_WORLD), seed, player.config, begin=lambda engine: engine.begin_recording(player))


def chosen_experiment(args: argparse.Namespace, running: bool) -> First:
    """A trial of an experiment from its beginning. running: as in `first_of_trial`."""
    from app.protocol.experiment import chosen_trial, find_experiment

    _refuse(args, _NOT_WITH_EXPERIMENT, "--experiment, which has its own world and parameters")
    experiment = find_experiment(args.experiment)
    trial = chosen_trial(experiment, args.engine, args.levels, args.seed)
    return first_of_trial(trial, None, experiment.title, running)


def first_of_trial(trial: Trial, moment_s: float | None, title: str, running: bool) -> First:
    """A trial, from its beginning or run ahead to a moment. title: of its experiment. running: whether it plays at once."""
    from app.code_version import code_version
    from app.engine.watched_trial import CHANGED

    config = Config().with_values(trial.values)
    world = open_world(trial.world, robot_radius_m=config.robot.robot_radius_m)

    def begin(engine: Engine) -> None:
        run = engine.begin_trial(trial, title, moment_s)
        if trial.version != code_version():
            run.event_log.note("warning", CHANGED)
        engine.running = running or engine.runs_ahead

    own_worlds.tidy()
    return First(world, trial.seed, config, begin=begin)


def _refuse(args: argparse.Namespace, names: tuple[str, ...], option: str) -> None:
    """ValueError if one of these options, or a world, is given beside `option`, which ends with the reason."""
    for name in names:
        if (given := getattr(args, name)) is not None and given is not False and given != []:  # seed 0 is given
            raise ValueError(f"--{name.replace('_', '-')} does not go with {option}")
    if args.world != DEFAULT_WORLD:
        raise ValueError(f"--world {args.world} does not go with {option}")

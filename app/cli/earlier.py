"""What `ratslam run` finds from earlier programs and offers to go on with: a brain that was kept, a run that was cut off."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.kept_brains.files import KeptBrain
    from app.runs.run_file import KeptRun
    from web import messages as m


def going_on(kept: KeptRun, tell: Callable[[float], object]) -> m.GoOn:
    """The run in the session where it was left. tell: is told the share that is done, and may raise to give it up."""
    from app.runs.replay import resumed
    from web import messages as m

    done_s = 0.0

    def told(seconds: float) -> None:
        nonlocal done_s
        done_s += seconds
        tell(min(1.0, done_s / max(kept.length_s, 1e-9)))

    return m.GoOn(kept, resumed(kept, told))


def cut_off_run() -> KeptRun | None:
    """The newest run, if it was cut off in the middle, by a crash or a kill."""
    from app.runs.folder import all_runs, is_open
    from app.runs.run_file import open_run

    for folder in all_runs()[:1]:
        try:
            run = open_run(folder)
        except ValueError:
            return None
        if run.last_tick > 0 and not run.end and not is_open(folder):
            print(f"The run {run.name} was cut off: go on with it by `ratslam run --resume {run.name}`", flush=True)
            return run
    return None


def kept_brain(args: argparse.Namespace) -> KeptBrain | None:
    """The brain kept last: with --resume-brain set up to be run, without it returned, to be offered on the page."""
    from app.kept_brains.files import folder, newest

    kept = newest()
    if not args.resume_brain:
        if kept is None or args.brain is not None:
            return None
        print(f"There is {kept.words}: go on with it by `ratslam run --resume-brain`", flush=True)
        return kept
    if args.brain is not None:
        raise ValueError(f"--resume-brain takes the brain that was kept last; do not give --brain {args.brain} with it")
    if kept is None:
        raise ValueError(f"--resume-brain: no brain is kept in {folder()}")
    args.brain, args.world, args.seed = kept.path, kept.about.world, kept.about.seed
    return None

"""`ratslam run`: the dashboard."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING

from app.cli.options import Verbs, add_session_options, session_of
from app.config import Config
from app.startup.compiling import Compiling
from app.startup.waking import Waking
from ratslam_core import RatSlam, load_brain
from sim2d import World, own_worlds

if TYPE_CHECKING:
    from app.kept_brains.files import KeptBrain

ENGINE_PATIENCE_S = 2.0  # how long leaving waits for a tick that hangs


def add_run(commands: Verbs) -> None:
    run = commands.add_parser("run", help="open the dashboard (this is what `ratslam` alone does)")
    add_session_options(run)
    run.add_argument("--port", type=_port, default=8000, help="port on 127.0.0.1; 0 = any free one (default 8000)")
    run.add_argument("--no-browser", action="store_true", help="only print the address")
    run.add_argument("--paused", action="store_true", help="start paused")
    run.add_argument(
        "--speed", type=float, default=1.0, help="simulated seconds per second, 0.25 to 16; 0 = as fast as possible"
    )
    run.add_argument(
        "--resume-brain", action="store_true", help="go on with the brain kept last, in its world and with its seed"
    )
    run.set_defaults(do=_run)


def _port(text: str) -> int:
    port = int(text) if text.isdigit() else -1
    if not 0 <= port <= 65535:
        raise argparse.ArgumentTypeError(f"a port is a whole number from 0 to 65535, got {text!r}")
    return port


def _run(args: argparse.Namespace) -> int:
    from web.messages.commands import SPEEDS, is_speed

    if not is_speed(args.speed):
        raise ValueError(f"--speed must be {SPEEDS}, got {args.speed:g}")
    own_worlds.tidy()
    kept = _resume(args)
    world, config, brain = session_of(args)
    compiling = Compiling()  # runs in the background while the rest is loaded
    try:
        return _serve(args, (world, config, brain), compiling, kept)
    finally:
        compiling.stop()


def _serve(
    args: argparse.Namespace, begin: tuple[World, Config, RatSlam | None], compiling: Compiling, kept: KeptBrain | None
) -> int:
    from app.engine_thread import EngineThread
    from app.kept_brains.keeper import BrainKeeper
    from web.http.kept_offer import Offered
    from web.http.server import CannotListen, Dashboard
    from web.viewer.viewers import Viewers

    world, config, brain = begin
    engine = EngineThread(world, args.seed, config, speed=args.speed, running=not args.paused, brain=brain)
    viewers = Viewers(engine.latest, engine.submit)
    offered = kept and Offered(**asdict(kept.about), read=partial(load_brain, kept.path))
    dashboard = Dashboard(engine.latest, engine.submit, viewers, port=args.port, offered=offered)
    try:
        dashboard.bind()
    except CannotListen as error:
        raise ValueError(str(error)) from None

    waking, keeper = Waking(engine, compiling), BrainKeeper(engine.latest, engine.submit)
    dashboard.on_ready, engine.on_stillborn = partial(_tell, args), dashboard.stop
    waking.start()
    keeper.start()
    try:
        dashboard.run()
    finally:
        keeper.stop()
        waking.stop(ENGINE_PATIENCE_S)
    if engine.stillborn is not None:
        raise ValueError(f"the engine could not begin: {engine.stillborn}")
    return 0


def _tell(args: argparse.Namespace, url: str) -> None:
    print(f"RatSLAM is alive at {url}  (Ctrl+C ends it)", flush=True)
    if not args.no_browser and _has_screen():
        webbrowser.open(url)


def _resume(args: argparse.Namespace) -> KeptBrain | None:
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


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))

"""`ratslam run --class`: whether and where a class in the local network is let in."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from web.http.class_door import Classroom
    from web.http.server import ForClass

PORT = 8001


def add_class_options(run: argparse.ArgumentParser) -> None:
    run.add_argument(
        "--class", dest="for_class", action="store_true", help="a class in the local network votes and looks on"
    )
    run.add_argument("--class-address", metavar="ADDRESS", help="with --class: at this address of the machine")
    run.add_argument(
        "--class-port", type=int, metavar="PORT", help=f"with --class: port (default {PORT}, 0 = any free one)"
    )


def for_class(args: argparse.Namespace) -> ForClass | None:
    """Where a class is let in. ValueError: an option says where, but not that."""
    if args.for_class:
        from web.http.server import ForClass

        return ForClass(args.class_address, PORT if args.class_port is None else args.class_port)
    for name in ("class-address", "class-port"):
        if getattr(args, name.replace("-", "_")) is not None:
            raise ValueError(f"--{name} goes with --class, which lets a class in")
    return None


def class_words(classroom: Classroom) -> str:
    return (
        f"A class votes at {classroom.url} and looks on at {classroom.url}?watch, as can whoever is in the same network"
    )

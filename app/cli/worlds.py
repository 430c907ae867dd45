"""`ratslam worlds`: list the worlds that come with the program, check a file, import a plan, print the schema."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from app.cli.options import Verbs, print_note
from disk import write_whole
from disk.words import shown


def add_worlds(commands: Verbs) -> None:
    worlds = commands.add_parser("worlds", help="list the worlds; check or import one of your own")
    worlds.set_defaults(do=_list)
    verbs = worlds.add_subparsers(title="commands")

    check = verbs.add_parser("check", help="report every fault of a world file, by line and value")
    check.add_argument("file", type=Path, metavar="FILE", help="a world, or anything that can be imported")
    check.add_argument("--scale", type=float, metavar="M", help="metres per pixel, for a plain picture")
    check.set_defaults(do=_check)

    take = verbs.add_parser("import", help="make a world from a map_server file, a vector map or a picture")
    take.add_argument("file", type=Path, metavar="FILE", help=".yaml, .json (list of segments), .pgm, .png, ...")
    take.add_argument("--scale", type=float, metavar="M", help="metres per pixel, for a plain picture")
    take.add_argument("--seed", type=int, default=0, help="seed for the looks of the walls (default 0)")
    take.add_argument("-o", "--output", type=Path, required=True, metavar="WORLD.json")
    take.set_defaults(do=_import)

    schema = verbs.add_parser("schema", help="print the JSON schema of world files")
    schema.set_defaults(do=_schema)


def _list(_args: argparse.Namespace) -> int:
    from sim2d import own_worlds
    from sim2d.world.world_file import our_worlds

    for name, world in our_worlds():
        x0, y0, x1, y1 = world.bounds
        print(f"{name:12} {world.title}; {x1 - x0:g} x {y1 - y0:g} m; {world.paper or 'ours'}: {world.about}")
    for name, title in own_worlds.names():
        print(f"{name:12} {title}; yours, in {own_worlds.folder()}")
    return 0


def _check(args: argparse.Namespace) -> int:
    found = _complaints(args.file, args.scale)
    for complaint in found:
        print(shown(f"ratslam: {complaint}"), file=sys.stderr)
    if not found:
        print(f"{args.file}: nothing is wrong with it")
    return 2 if found else 0


def _complaints(path: Path, scale_m: float | None) -> list[str]:
    """Every fault of a world file; of a plan that is imported, only the first."""
    from sim2d import WorldError
    from sim2d.importers import import_file
    from sim2d.world.world_file import complaints, parse_json

    try:
        if path.suffix.lower() == ".json":
            text = path.read_text("utf-8")
            if not isinstance(parse_json(text, path.name), list):
                return complaints(text, path.name)
        import_file(path, scale_m, tell=print_note)
    except (OSError, UnicodeDecodeError) as error:
        return [f"{path}: cannot be read: {error}"]
    except WorldError as error:
        return [str(error)]
    return []


def _import(args: argparse.Namespace) -> int:
    if args.seed < 0:
        raise ValueError(f"--seed must be 0 or larger, got {args.seed}")
    from sim2d import world_to_json
    from sim2d.importers import import_file

    world = import_file(args.file, args.scale, args.seed, tell=print_note)
    write_whole(args.output, world_to_json(world))
    print(f"{args.output}: {world.title}, {len(world.walls)} walls, {len(world.starts)} starts")
    return 0


def _schema(_args: argparse.Namespace) -> int:
    from sim2d.world.world_file import schema_text

    print(schema_text(), end="")
    return 0

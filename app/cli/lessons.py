"""`ratslam lessons`: lists the lessons, checks a file, runs one without a page."""

from __future__ import annotations

import argparse
import shlex
import time
from pathlib import Path

from app.cli.options import Verbs, checked_seed
from disk.words import shown


def add_lessons(commands: Verbs) -> None:
    parser = commands.add_parser(
        "lessons",
        help="list the lessons, check one of your own, run one without a page",
        description="Without options: lists them.",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", type=Path, metavar="FILE", help="say whether a file of your own is right")
    what.add_argument(
        "--run", metavar="NAME|FILE", help="run one, and tell what came of it and whether it keeps what it promises"
    )
    what.add_argument("--time", action="store_true", help="tell how long each takes to set its scene, and to be shown")
    parser.add_argument("--seed", type=int, metavar="N", help="with --run: another seed than the lesson's")
    parser.set_defaults(do=_lessons)


def _lessons(args: argparse.Namespace) -> int:
    if args.seed is not None and args.run is None:
        raise ValueError(f"--seed {args.seed} goes with --run NAME")
    if args.check is not None:
        return _check(args.check)
    if args.run is not None:
        return _run(args.run, None if args.seed is None else checked_seed(args.seed))
    return _time() if args.time else _list()


def _list() -> int:
    from app.protocol.lesson import all_lessons, own_folder, own_lessons

    for number, lesson in enumerate(all_lessons(), start=1):
        print(f"{number:2}  {lesson.name:18} {lesson.title} ({lesson.paper})")
        print(f"    {'':18} {lesson.idea}")
    for path, found in own_lessons():
        print(shown(f"{path.name}: " + (found if isinstance(found, str) else f"yours, in {own_folder()}")))
    return 0


def _check(path: Path) -> int:
    from app.gallery import check_formulas
    from app.protocol.lesson import check_lesson, read_lesson
    from app.protocol.lesson_card import wordy_states

    lesson = read_lesson(path)
    try:
        check_lesson(lesson)
        check_formulas(lesson)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    command = shlex.join(["ratslam", "lessons", "--run", str(path)])
    print(f"{path}: {lesson.title}: all is right; `{command}` tells whether it keeps what it promises")
    for words in wordy_states(lesson):
        print(f"{path}: {words}")
    return 0


def _run(name: str, seed: int | None) -> int:
    from app.cli.options import compile_first
    from app.protocol.lesson import find_lesson, read_lesson
    from app.protocol.lesson_round import report_of

    lesson = read_lesson(Path(name)) if name.endswith(".toml") else find_lesson(name)
    compile_first()
    report = report_of(lesson, seed)
    print("\n".join(report.lines))
    return 0 if report.kept else 1


def _time() -> int:
    from app.cli.options import compile_first
    from app.protocol.lesson import all_lessons
    from app.protocol.lesson_round import set_scene, show_to_end

    compile_first()
    print(f"{'lesson':18}  to set the scene of each round    to show them, as fast as possible")
    total_s = 0.0
    for lesson in all_lessons():
        scenes_s: list[float] = []
        shown_s = 0.0
        for number in range(lesson.round_count):
            began = time.perf_counter()
            round_ = set_scene(lesson, number)
            scenes_s.append(time.perf_counter() - began)
            show_to_end(round_)
            shown_s += time.perf_counter() - began - scenes_s[-1]
        scenes = ", ".join(f"{s:.2f}" for s in scenes_s)
        total_s += sum(scenes_s) + shown_s
        print(f"{lesson.name:18}  {scenes + ' s':32}  {shown_s:.1f} s", flush=True)
    print(f"all together: {total_s:.0f} s")
    return 0

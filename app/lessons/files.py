"""The lessons there are: those that come with the program, and the user's own in ~/.ratslam/lessons. A mistake is told with
its line of the TOML file, which TOML's readers do not tell."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, cast

from pydantic import ValidationError

from app.config.toml_file import read_text, toml_tree
from app.lessons.schema import Lesson
from disk import kept_folder

_TABLE = re.compile(r"^\s*(\[\[?)\s*([A-Za-z0-9_.\"'-]+)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"^\s*([A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')\s*=")


def line_of(text: str, path: Sequence[str | int]) -> int:
    """The line, from 1, of the value at this path; of the innermost part of it that has a line of its own."""
    table: list[str | int] = []
    counts: dict[str, int] = {}
    best, deepest = 1, 0
    for number, line in enumerate(text.splitlines(), start=1):
        header, key = _TABLE.match(line), _KEY.match(line)
        if header is not None:
            name = header.group(2)
            table = list(name.split("."))
            if header.group(1) == "[[":
                counts[name] = counts.get(name, -1) + 1
            for k in range(len(table), 0, -1):  # [a.b] below [[a]] is of its newest item
                prefix = ".".join(str(part) for part in table[:k] if isinstance(part, str))
                if prefix in counts:
                    table.insert(k, counts[prefix])
            here: list[str | int] = table
        elif key is not None:
            here = [*table, key.group(1).strip("\"'")]
        else:
            continue
        if len(here) > deepest and list(path[: len(here)]) == here:
            best, deepest = number, len(here)
    return best


_CATALOGUE = Path(__file__).with_name("catalogue")
ENVIRONMENT = "RATSLAM_LESSONS"


def own_folder() -> Path:
    """RATSLAM_LESSONS, or `.ratslam/lessons` in the home directory: where a teacher's own lie. ValueError without a home."""
    return Path(os.environ.get(ENVIRONMENT) or kept_folder() / "lessons")


def read_lesson(path: Path) -> Lesson:
    """ValueError: file, line, name, value, and what would be right."""
    try:
        text = read_text(path)
        tree = toml_tree(text)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    _find_world(path, tree)
    try:
        return Lesson.model_validate(tree)
    except ValidationError as error:
        first = error.errors()[0]
        where = _without_kinds(first["loc"])
        name = ".".join(str(part + 1) if isinstance(part, int) else part for part in where) or "the file"
        what = first["msg"].removeprefix("Value error, ")
        got = "" if first["type"] == "missing" or first["msg"] != what else f", got {_shown(first['input'])}"
        raise ValueError(f"{path}, line {line_of(text, where)}: {name}: {what[0].lower()}{what[1:]}{got}") from None


def _find_world(path: Path, tree: dict[str, Any]) -> None:
    """A world may be a file beside the lesson's."""
    scene = tree.get("scene")
    name = cast("dict[str, object]", scene).get("world") if isinstance(scene, dict) else None
    if isinstance(name, str) and os.path.isfile(beside := path.parent / name):  # False also for what can be no name
        cast("dict[str, object]", scene)["world"] = str(beside)


def check_lesson(lesson: Lesson) -> None:
    """ValueError says what does not fit together: a world, a place, a door."""
    from app.lessons.performance import Performance, session_of
    from app.views.history import History

    for number in range(lesson.round_count):
        session = session_of(lesson, number)
        Performance(lesson, number, session, History(session))


def catalogue() -> Iterator[Lesson]:
    """The lessons that come with the program, in their order."""
    for path in sorted(_CATALOGUE.glob("*.toml")):
        yield read_lesson(path)


def own_lessons() -> Iterator[tuple[Path, Lesson | str]]:
    """The user's, each read or with what is wrong with it."""
    try:
        folder = own_folder()
    except ValueError:  # no home directory, so none of one's own
        return
    for path in sorted(folder.glob("*.toml")):
        try:
            yield path, read_lesson(path)
        except ValueError as error:
            yield path, str(error)


def all_lessons() -> list[Lesson]:
    """Those that can be begun. One of the user's takes the place of one of the program's with the same name."""
    found = {lesson.name: lesson for lesson in catalogue()}
    found.update({lesson.name: lesson for _, lesson in own_lessons() if isinstance(lesson, Lesson)})
    return list(found.values())


def find_lesson(name: str) -> Lesson:
    """A lesson by name. ValueError lists the names there are."""
    lessons = {lesson.name: lesson for lesson in all_lessons()}
    if name not in lessons:
        raise ValueError(f"there is no lesson {name!r}; expected one of: {', '.join(lessons)}")
    return lessons[name]


def _without_kinds(path: tuple[str | int, ...]) -> list[str | int]:
    """pydantic names the kind of a step after its number: as the file has no such level, it is left out."""
    return [
        part for k, part in enumerate(path) if not (isinstance(part, str) and k and path[k - 2 : k - 1] == ("steps",))
    ]


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."

"""One rule for names at every door in, and every language that a name is written into reads it as text."""

from __future__ import annotations

import ast
import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from app.config import Config
from app.experiments.export import write_csv
from app.experiments.figures import draw
from app.experiments.figures.canvas import svg_of
from app.experiments.report import check_drawing
from app.experiments.summary import table_of
from app.orders import Order, check_order
from app.protocol.experiment import Level, Score, read_experiment
from app.protocol.lesson import check_lesson, read_lesson
from app.run_record.bookmarks import Bookmarks
from app.run_record.header import Beginning, header_of, read_header, written
from app.run_record.link import python_lines
from app.run_record.situation import Situation
from app.startup.ending import ended
from disk.words import plain, shown
from sim2d import load_world, world_from_json, world_to_json
from sim2d.importers import open_world
from web.http.commands import Declined, check
from web.http.worlds import NewWorld

from .made_trials import experiment, figure, trials
from .made_trials import material as made_material
from .sessions import a_session
from .test_experiment_files import LEAST

HOSTILE = [
    "a\nb", "a\r", "a\0b", "\x1b[31mred\x1b]0;owned\x07", "\x9b31m", "a\u202eb", "\u2066a", "a\u2028b", "\ud800",
    "a\ufeffb", "\uffff",
]  # fmt: skip
NICE = [
    "Küche 3", "会議室　２", "می‌شود", "👩‍🔬 lab", "<script>alert(1)</script>", "$\\frac{", "]]>", "=cmd()", "[/red]", "100 %",
]  # fmt: skip
WORLD = load_world("office")
OFFICE = json.loads(world_to_json(WORLD))
LESSON = next((Path(__file__).parents[3] / "app" / "protocol" / "lessons").glob("01-*.toml")).read_text("utf-8")


def _world(**changes: object) -> None:
    world_from_json(json.dumps({**OFFICE, **changes}), "mine.json")


def _run(name: str) -> None:
    line = written(header_of(Beginning(world_to_json(WORLD), "office", 1, Config())))
    line["run"]["trial"] = name
    read_header(line)


def _file(tmp: Path, text: str) -> Path:
    (tmp / "mine.toml").write_text(text, "utf-8")
    return tmp / "mine.toml"


def _lesson(tmp: Path, name: str) -> None:
    read_lesson(_file(tmp, LESSON.replace("title = ", f"title = {_toml(name)} #", 1)))


def _experiment(tmp: Path, name: str) -> None:
    read_experiment(_file(tmp, LEAST.replace('label = "map error"', f"label = {_toml(name)}")))


def _toml(text: str) -> str:
    return '"' + "".join(f"\\U{ord(c):08X}" for c in text) + '"'


DOORS: dict[str, Callable[[Path, str], object]] = {
    "world's name": lambda _, name: _world(name=name),
    "world's title": lambda _, name: _world(title=name),
    "place": lambda _, name: _world(places=[{"name": name, "x": 1.0, "y": 1.0}]),
    "tag by API": lambda _, name: check({"type": "tag", "name": name}),
    "bookmark by API": lambda _, name: check({"type": "put_bookmark", "name": name}),
    "box by API": lambda _, name: check({"type": "put_box", "name": name, "x": 1.0, "y": 1.0}),
    "second brain by API": lambda _, name: check({"type": "compare_brains", "pair": "papers", "name": name}),
    "new world": lambda _, name: NewWorld(name=name, title=name, width_m=5.0, depth_m=5.0),
    "tag": lambda _, name: a_session().tag(name),
    "tag in a file": lambda _, name: check_order(Order(0, "tag", {"name": name})),
    "bookmark": lambda _, name: Bookmarks().put(1, 0.1, name),
    "run": lambda _, name: _run(name),
    "lesson": _lesson,
    "experiment": _experiment,
}


@pytest.mark.parametrize("door", DOORS)
def test_a_name_holds_nothing_that_another_reader_would_obey(door: str, tmp_path: Path) -> None:
    refusals: list[str] = []
    for name in HOSTILE:
        with pytest.raises((ValueError, Declined)) as refused:
            DOORS[door](tmp_path, f"x{name}y")  # not at its ends, where some doors cut off spaces
        refusals.append(str(refused.value))
    if door != "new world":  # whose refusal becomes a sentence in `checked_body`
        assert [words for words in refusals if shown(words) != words] == []
    for name in NICE:
        DOORS[door](tmp_path, name)


def test_a_world_with_a_hostile_name_is_no_code() -> None:
    name = 'x"); open("PWNED", "w") #'
    world = world_to_json(WORLD).replace('"name": "office"', f'"name": {json.dumps(name)}', 1)
    situation = Situation(header_of(Beginning(world, name, 1, Config())), (), 0, "0" * 64)
    tree = ast.parse(python_lines(situation, f"{name}.json"))
    calls = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    assert {call.id for call in calls if isinstance(call, ast.Name)} == {"read_situation", "Path"}


def test_labels_are_drawn_and_printed_as_they_are(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Mathtext, XML, rich's markup and spreadsheets each have signs that stand for something else."""
    odd = ["$\\foo$", "5 $ to 6 $_{", "[/red]", "=1+1", "]]>&<"]
    axis, other = experiment().axes
    axis = axis.model_copy(update={"levels": [Level(label=label) for label in odd], "name": "@axis"})
    score = Score(label="$\\frac{$", score="error_m", unit="$\\int")
    figures = [
        figure("dots", score="$\\frac{$", by="@axis", log=True),
        figure("curves", score="$\\frac{$", along="@axis", lines="size"),
    ]
    made = experiment(trials=1, axes=[axis, other], scores=[score], original=[], title="$\\frac{", figures=figures)
    check_drawing(made)
    svg = svg_of(draw(figures[0], made_material(made)).figure)
    assert all(label.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;") in svg for label in odd)
    Console(width=300).print(table_of(made, made_material(made).cells))
    printed = capsys.readouterr().out
    assert all(label in printed for label in [*odd, score.label])
    write_csv(tmp_path / "table.csv", made, trials(made))
    with (tmp_path / "table.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][2] == "'@axis"
    assert {row[2] for row in rows[1:]} == {"$\\foo$", "5 $ to 6 $_{", "[/red]", "'=1+1", "]]>&<"}


def test_what_cannot_be_drawn_is_found_before_it_is_run() -> None:
    first, size = experiment().axes
    size = size.model_copy(update={"levels": [Level(label="big")]})
    curves = figure("curves", score="map error", along="size", spacing="log")
    made = experiment(figures=[curves], axes=[first, size])
    with pytest.raises(ValueError, match=r"A figure of curves.* cannot be drawn: spacing = 'log': there is no number"):
        check_drawing(made)


def test_an_error_that_repeats_foreign_text_leaves_the_terminal_alone(capsys: pytest.CaptureFixture[str]) -> None:
    def refuse() -> int:
        raise ValueError("unknown key '\x1b[31m\u202e'")

    assert ended(refuse) == 2
    assert capsys.readouterr().err == "ratslam: unknown key '\\x1b[31m\\u202e'\n"
    assert plain("a\nb\x1b[0m") == "a b?[0m"


def test_names_without_an_end_are_refused_in_a_sentence_of_some_length(tmp_path: Path) -> None:
    """A world of a hundred thousand letters was a file name too long for the system."""
    path = _file(tmp_path, LESSON.replace('world = "office"', f'world = "{"a" * 3000}"', 1))
    for opened in (lambda: check_lesson(read_lesson(path)), lambda: open_world("a" * 100_000)):
        with pytest.raises(ValueError, match="no world 'aaa"):
            opened()
    assert len(shown(f"key {'a' * 100_000}: unknown")) < 1100

"""One rule for names at every door in, and every language that a name is written into reads it as text."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from app.experiments.export import write_csv
from app.experiments.figures import draw
from app.experiments.figures.canvas import svg_of
from app.experiments.report import check_drawing
from app.experiments.result_table import table_of
from app.lessons.files import check_lesson, read_lesson
from app.order_book import Order
from app.runs.bookmarks import Bookmarks
from app.runs.header import Beginning, header_of, read_header, written
from app.runs.order_check import check_order
from app.session import Session
from app.situations.python_lines import python_lines
from app.situations.situation import Situation
from app.startup.ending import ended
from app.trials.experiment import Level, Score, read_experiment
from disk.words import plain, shown
from sim2d import load_world, world_from_json, world_to_json
from sim2d.importers import open_world
from tests.unit.app.made_trials import experiment, figure, trials
from tests.unit.app.made_trials import material as made_material
from tests.unit.app.test_experiment_files import LEAST
from web.http.commands import Declined, check
from web.http.worlds import NewWorld

HOSTILE = [
    "a\nb",
    "a\r",
    "a\0b",
    "\x1b[31mred\x1b]0;owned\x07",
    "\x9b31m",
    "a\u202eb",
    "\u2066a",
    "a\u2028b",
    "\ud800",
    "a\ufeffb",
    "\uffff",
]
NICE = [
    "Küche 3",
    "会議室　２",
    "می‌شود",
    "👩‍🔬 lab",
    "<script>alert(1)</script>",
    "$\\frac{",
    "]]>",
    "=cmd()",
    "[/red]",
    "100 %",
]
OFFICE = json.loads(world_to_json(load_world("office")))
LESSON = next((Path(__file__).parents[3] / "app" / "lessons" / "catalogue").glob("01-*.toml")).read_text("utf-8")


def _world(**changes: object) -> None:
    world_from_json(json.dumps({**OFFICE, **changes}), "mine.json")


def _bookmark(name: str) -> None:
    Bookmarks().put(1, 0.1, name)


def _run(name: str) -> None:
    session = Session(load_world("office"), 1)
    header = header_of(Beginning(world_to_json(session.world), "office", 1, session.config))
    line = written(header)
    line["run"]["trial"] = name
    read_header(line)


def _lesson(tmp: Path, name: str) -> None:
    (tmp / "mine.toml").write_text(LESSON.replace("title = ", f"title = {_toml(name)} #", 1), "utf-8")
    read_lesson(tmp / "mine.toml")


def _experiment(tmp: Path, name: str) -> None:
    (tmp / "mine.toml").write_text(LEAST.replace('label = "map error"', f"label = {_toml(name)}"), "utf-8")
    read_experiment(tmp / "mine.toml")


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
    "tag": lambda _, name: Session(load_world("office"), 1).tag(name),
    "tag in a file": lambda _, name: check_order(Order(0, "tag", {"name": name})),
    "bookmark": lambda _, name: _bookmark(name),
    "run": lambda _, name: _run(name),
    "lesson": _lesson,
    "experiment": _experiment,
}


@pytest.mark.parametrize("door", DOORS)
def test_a_name_holds_nothing_that_another_reader_would_obey(door: str, tmp_path: Path) -> None:
    let_in: list[str] = []
    refusals: list[str] = []
    for name in HOSTILE:
        try:
            DOORS[door](tmp_path, f"x{name}y")  # not at its ends, where some doors cut off spaces
        except (ValueError, Declined) as error:
            refusals.append(str(error))
        else:
            let_in.append(name)
    assert let_in == []
    if door != "new world":  # whose refusal becomes a sentence in `checked_body`
        assert [words for words in refusals if shown(words) != words] == []
    for name in NICE:
        DOORS[door](tmp_path, name)


def test_a_world_with_a_hostile_name_is_no_code(offices_header: Callable[[str], Situation]) -> None:
    situation = offices_header('x"); open("PWNED", "w") #')
    lines = python_lines(situation, 'x"); open("PWNED", "w") #.json')
    names = {node.id for node in _calls(lines)}
    assert names == {"read_situation", "Path"}


@pytest.fixture
def offices_header() -> Callable[[str], Situation]:
    def made(name: str) -> Situation:
        session = Session(load_world("office"), 1)
        world = world_to_json(session.world).replace('"name": "office"', f'"name": {json.dumps(name)}', 1)
        return Situation(header_of(Beginning(world, name, 1, session.config)), (), 0, "0" * 64)

    return made


def _calls(lines: str) -> list:
    import ast

    return [
        node.func
        for node in ast.walk(ast.parse(lines))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    ]


def test_labels_are_drawn_and_printed_as_they_are(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Mathtext, XML, rich's markup and spreadsheets each have signs that stand for something else."""
    odd = ["$\\foo$", "5 $ to 6 $_{", "[/red]", "=1+1", "]]>&<"]
    made = experiment(trials=1)
    axis = made.axes[0].model_copy(update={"levels": [Level(label=label) for label in odd], "name": "@axis"})
    score = Score(label="$\\frac{$", score="error_m", unit="$\\int")
    made = made.model_copy(
        update={"axes": [axis, made.axes[1]], "scores": [score], "original": [], "title": "$\\frac{"}
    )
    figures = [
        figure("dots", score="$\\frac{$", by="@axis", log=True),
        figure("curves", score="$\\frac{$", along="@axis", lines="size"),
    ]
    made = made.model_copy(update={"figures": figures})
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
    made = experiment(figures=[figure("curves", score="map error", along="size", spacing="log")])
    made = made.model_copy(
        update={"axes": [made.axes[0], made.axes[1].model_copy(update={"levels": [Level(label="big")]})]}
    )
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
    text = LESSON.replace('world = "office"', f'world = "{"a" * 3000}"', 1)
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    with pytest.raises(ValueError, match="no world 'aaa"):
        check_lesson(read_lesson(tmp_path / "mine.toml"))
    with pytest.raises(ValueError, match="no world 'aaa"):
        open_world("a" * 100_000)
    assert len(shown(f"key {'a' * 100_000}: unknown")) < 1100

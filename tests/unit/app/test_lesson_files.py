"""Files of lessons: what is wrong with one is said with file, line, name, value and what would be right."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.gallery import StoredLessons, check_formulas, formula_text
from app.protocol.files import line_of
from app.protocol.lesson import (
    Finding,
    Formula,
    Symbol,
    all_lessons,
    catalogue,
    check_lesson,
    fill_in,
    find_lesson,
    read_lesson,
)
from app.protocol.lesson_round import report_of

from .lessons_to_give import short_lesson

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
FILE = ROOT / "app" / "protocol" / "lessons" / "10-kidnapped.toml"
TEXT = FILE.read_text("utf-8")


@pytest.mark.parametrize(
    ("old", "new", "line_with", "words"),
    [
        ("limit_s = 180", 'limit_s = "long"', "limit_s", r"show.limit_s: input should be a valid number.*, got 'long'"),
        ("least_m = 4", "least_m = -4", "least_m", r"show.steps.1.least_m: input should be greater .* 0, got -4"),
        ("then_s = 3", "then_m = 3", "then_m", r"show.then_m: extra inputs are not permitted, got 3"),
        ('what = "found again"', 'what = "found"', "until =", r"show.until.what: input should be 'closure', .*'found'"),
        ('measure = "found_s" }\noptions', 'measure = "fnd" }\noptions', "finding =", r"predict.finding.measure: nothing"),
        ("{found_m}", "{way}", "name =", r"nothing is measured by the name 'way'"),
        (", at_least = 0.2 }", " }", "promise =", r"promise.1: a promise without at_least and below"),
        ('commands = [{ type = "kidnap" }]', 'commands = [{ type = "kid" }]', "[[sandbox]]", r"sandbox.1: .*is no command"),
        ("at_least = 2, below = 30", "at_least = 1, below = 30", "[predict]", r"can both be right: their bounds overlap"),
        ('title = "Kidnapped"\n', "", "name =", r"title: field required"),
        ('view = "all"', 'set = { "pilot.speed" = 1.0 }', "set =", r"scene.set: .*pilot.speed"),
        ('view = "all"', 'set = { "pilot.cruise_speed" = 9.0 }', "set =", r"scene.set: .*pilot.cruise_speed"),
        ('"local_view.saturation"', '"local_view.saturate"', "symbols =", r"one is 'local_view.saturation'"),
        ("[scene]", "[scene", "[scene", r"not valid TOML: .*line"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_line(tmp_path: Path, old: str, new: str, line_with: str, words: str) -> None:
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=words) as raised:
        read_lesson(path)
    assert str(raised.value).startswith(str(path))
    if "not valid TOML" not in words:
        line = int(str(raised.value).split("line ")[1].split(":")[0])
        assert line_with in text.splitlines()[line - 1]


def test_what_does_not_fit_together_is_told_before_it_begins() -> None:
    for changes, words in (
        ({"scene": {"world": "castle"}}, "castle"),
        ({"show": {"steps": [{"do": "click", "place": "the moon"}]}}, "no place 'the moon'"),
        ({"outcome": "{path_m of quick}"}, "there is no round 'quick'"),
    ):
        with pytest.raises(ValueError, match=words):
            check_lesson(short_lesson(**changes))


def test_the_lines_of_nested_tables() -> None:
    text = "a = 1\n[b]\nc = 2\n[[d]]\ne = 3\n[[d]]\n[[d.f]]\ng = 4\n"
    paths = ["a"], ["b", "c"], ["d", 0, "e"], ["d", 1], ["d", 1, "f", 0, "g"]
    assert [line_of(text, path) for path in paths] == [1, 3, 5, 6, 8]


def test_what_was_found_stands_in_the_text() -> None:
    rounds = [("slow", {"path_m": 1.0, "found_s": float("inf")}), ("fast", {"path_m": 3.0, "found_s": 2.0})]
    assert fill_in("{path_m of slow}, {path_m}, {found_s of slow}", rounds) == "1.0 m, 3.0 m, never"
    assert Finding(measure="path_m", minus="path_m of slow").of(rounds) == 2.0
    assert Finding(measure="path_m", over="path_m of slow").of(rounds) == 3.0


def test_symbols_are_marked_by_their_parameters_and_only_those() -> None:
    symbols = {r"\alpha": "experience_map.correction", r"s_{\max}": "local_view.saturation", "x_i": None}
    formula = Formula(
        latex=r"\alpha + s_{\max} x_i", says="A sum.", source="none",
        symbols=[Symbol(symbol=symbol, means="it", parameter=name) for symbol, name in symbols.items()],
    )  # fmt: skip
    text = formula_text(formula, {"experience_map.correction": "0.5", "local_view.saturation": "0.02"})
    assert text.mathml.count("data-parameter") == 2
    assert '<mi data-parameter="experience_map.correction">' in text.mathml
    assert '<msub data-parameter="local_view.saturation">' in text.mathml
    for wrong in (r"\left( x", r"\foo x"):
        with pytest.raises(ValueError, match="cannot be typeset"):
            formula_text(Formula(latex=wrong, says="x", source="x"), {})


def test_a_lesson_of_ones_own_is_listed_and_a_wrong_one_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RATSLAM_LESSONS", str(tmp_path))
    (tmp_path / "mine.toml").write_text(TEXT.replace('name = "kidnapped"', 'name = "mine"'))
    (tmp_path / "wrong.toml").write_text(TEXT.replace("limit_s = 180", "limit_s = -1"))
    (tmp_path / "better.toml").write_text(TEXT.replace('title = "Kidnapped"', 'title = "My kidnap"'))
    assert find_lesson("mine").title == "Kidnapped"
    assert find_lesson("kidnapped").title == "My kidnap"
    cards = {card.name: card for card in StoredLessons().cards()}
    assert (cards["mine"].own, cards["packet"].own, cards["kidnapped"].own) == (True, False, True)
    assert cards["wrong"].wrong is not None
    assert "show.limit_s" in cards["wrong"].wrong


def test_the_catalogue_is_in_order_and_its_names_are_its_files() -> None:
    files = sorted(path.stem for path in FILE.parent.glob("*.toml"))
    lessons = list(catalogue())
    assert [f"{name[:2]}-{lesson.name}" for name, lesson in zip(files, lessons, strict=True)] == files
    assert [lesson.name for lesson in all_lessons()][: len(lessons)] == [lesson.name for lesson in lessons]


def test_the_lesson_in_the_document_keeps_its_promise(tmp_path: Path) -> None:
    document = (ROOT / "docs" / "lessons.md").read_text("utf-8")
    path = tmp_path / "turned.toml"
    path.write_text(document.split("```toml\n")[1].split("```")[0])
    to_copy = read_lesson(path)
    check_lesson(to_copy)
    check_formulas(to_copy)
    report = report_of(to_copy)
    assert report.kept, report.lines

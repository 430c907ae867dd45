"""docs/teaching.md names what is there: lessons, keys, buttons, parameters, commands; and what it says comes out, comes out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.config import Config
from app.config.presets import pairs_beside
from app.protocol.lesson import Lesson, catalogue
from app.protocol.lesson_round import report_of, run_round
from web.shared import TABS

ROOT = Path(__file__).parents[2]
STATIC = ROOT / "web" / "static"
PAGE = (ROOT / "docs" / "teaching.md").read_text("utf-8")
LESSONS = {lesson.name: lesson for lesson in catalogue()}
KEYS = (STATIC / "ui" / "keys.js").read_text("utf-8")
WRITTEN = {" ": "space", "Escape": "esc", "PageDown": "page down", "PageUp": "page up"}  # as in keys.js
CODE, SLANTED = r"(?<!`)`([^`\n]+)`", r"(?<!\*)\*([^*\n]+)\*(?!\*)"
OUTCOMES = dict(re.findall(r"^\| `(\w+)` \| (\d+ \| .+) \|$", PAGE, re.MULTILINE))
TAUGHT = re.findall(r"^\*\*\d:\d\d ([^*]+)\*\* \(`(\w+)`(.*?)\n\n", PAGE, re.MULTILINE | re.DOTALL)


def the_keys() -> set[str]:
    keys: set[str] = {key for row in re.findall(r"keys: \[(.*?)\]", KEYS) for key in re.findall(r'"(.+?)"', row)}
    return {WRITTEN.get(key, key) for key in keys}


def the_labels() -> set[str]:
    """What the page's elements say, what its scripts write, and what it is told by the server to write on buttons and tabs."""
    html = (STATIC / "index.html").read_text("utf-8")
    said = set(re.findall(r">\s*([^<>]+?)\s*<", html)) | set(re.findall(r'aria-label="([^"]+)"', html))
    for script in STATIC.rglob("*.js"):
        if "vendor" not in script.parts:
            said |= set(re.findall(r'"([^"\n]+)"', script.read_text("utf-8")))
    said |= {pair.title for pair in pairs_beside(Config())} | set(TABS)
    said |= {each.button or "" for lesson in LESSONS.values() for each in lesson.sandbox}
    return said | {f"Go on without {words}" for words in ("this view", "these views")}  # inspect.js


def unknown(code: str) -> bool:
    """Whether a piece of code is neither a lesson, a key, an address of the page nor a command."""
    if opened := re.fullmatch(r"/#lesson=(\w+)", code):
        return opened[1] not in LESSONS
    if run := re.match(r"ratslam lessons --run (\w+)", code):
        return run[1] not in LESSONS and run[1] != "NAME"
    if re.match(r"ratslam run\b|make run$|--seed \d+$|/\?(vote|watch)$", code):
        return False
    return code not in LESSONS and code not in the_keys() and code not in {"letters", "names"}


def test_every_lesson_key_address_command_and_label_exists() -> None:
    assert {code for code in re.findall(CODE, PAGE) if unknown(code)} == set()
    assert (unknown("sqare"), unknown("`")) == (True, True)
    labels = the_labels() | {"slanted words"}
    assert set(re.findall(SLANTED, PAGE)) - labels == set()
    assert "Let it happenn" not in labels


def test_every_lesson_has_its_outcome_and_is_called_as_on_its_card() -> None:
    assert set(OUTCOMES) == set(LESSONS)
    assert len(TAUGHT) >= 9
    for title, name, words in TAUGHT:
        assert title == LESSONS[name].title
        options = {option.words for option in LESSONS[name].predict.options}
        assert set(re.findall(r'"([^"]+)"', words.replace("\n", " "))) <= options, name


def test_the_lecture_has_the_figures_of_the_outcomes() -> None:
    """What Try it shows afterwards is told in whole seconds."""
    for _, name, words in TAUGHT:
        named = [name, *(code for code in re.findall(CODE, words) if code in LESSONS)]
        there = " ".join(OUTCOMES[each] + LESSONS[each].predict.question for each in named)
        assert set(re.findall(r"\d+\.\d+", words)) <= set(re.findall(r"\d+\.\d+", there)), name


def test_the_lessons_on_what_is_ours_are_named_by_their_numbers() -> None:
    ours = [number for number, lesson in enumerate(LESSONS.values(), 1) if lesson.paper.startswith("ours")]
    first, last = map(int, re.findall(r"lessons (\d+) to (\d+)", PAGE)[0])
    apart = int(re.findall(r"lessons \d+ to \d+, and (\d+)", PAGE)[0])
    together = list(LESSONS).index("beside") + 1  # is given just there
    assert ours == [*range(first, last + 1), together, apart]


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_the_rates_come_out_on_other_seeds_as_in_the_answers(seed: int) -> None:
    slow, quick, *off = re.findall(rf"^\| {seed} \| (.+) \| (.+) \| (.+) \| (.+) \|$", PAGE, re.MULTILINE)[0]
    said = report_of(LESSONS["rates"], seed).lines[1]
    assert f"after {slow}, with 1.00 after {quick}." in said
    assert f"{off[0]} and {off[1]} off" in said


@pytest.mark.long
def test_the_kidnaps_take_on_other_seeds_what_lesson_and_answers_say() -> None:
    times = re.findall(r"Seeds 1 to 6: ([\d., ]+) s\.", PAGE)[0].split(", ")
    found = [report_of(LESSONS["kidnapped"], seed).rounds[0].values for seed in range(1, 7)]
    took = [values["found_s"] for values in found if values is not None]
    assert [f"{time:.1f}" for time in took] == times
    assert f"{', '.join(f'{time:.0f}' for time in took[:5])} and {took[5]:.0f} s" in str(LESSONS["kidnapped"].more)


@pytest.mark.parametrize(("name", "kind", "answer"), [("loop", "closure", 4), ("snap", "snap", 5)])
def test_what_inspect_tells_of_it_stands_in_the_answers(name: str, kind: str, answer: int) -> None:
    """When it was, the views that led to it, by how much they differ or how often they were seen."""
    log = run_round(LESSONS[name], 0).history.log
    why = next(report for report in log.why.values() if report.kind == kind)
    chain = " ".join(words for _, words in why.chain)
    (task,) = re.findall(rf"^{answer}\. (.*?)^{answer + 1}\. ", PAGE, re.MULTILINE | re.DOTALL)
    (told,) = re.findall(rf"^\*\*{answer}\.\*\*(.*?)\n\n", PAGE, re.MULTILINE | re.DOTALL)
    minutes, seconds = divmod(int(why.time_s), 60)
    assert f"click {'loop closed' if kind == 'closure' else kind} {minutes}:{seconds:02}" in task
    for view, differs in re.findall(r"view (\d+) is recognised \(it differs by ([\d.]+)", chain):
        assert f"View {view} was recognised; it differs by {differs}" in told
    for view, looks, share in re.findall(r"view (\d+), learnt .*?: (\d+) looks? put (\d+)%", chain):
        assert f"View {view}: {looks} look" in told
        assert f", {share} %" in told


def comes_out_as_it_stands_there(lesson: Lesson, lines: tuple[str, ...]) -> None:
    """Checked where every lesson is given, in tests/integration/test_lessons.py."""
    assert OUTCOMES[lesson.name] == f"{lesson.scene.seed} | {lines[1]}"
    for _, name, words in TAUGHT:
        if name == lesson.name and (said := re.search(r'comes\s+out\s+as\s+"([^"]+)"', words)):
            assert lines[2].endswith(": " + said[1].replace("\n", " "))

"""What the card of a lesson has in sight is little enough to be read while a robot moves."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.cli import command_line as cli
from app.protocol.lesson import catalogue
from app.protocol.lesson_card import CARD, MOST_WORDS, count_words, words_in_sight, wordy_states

from .lessons_to_give import drawn_lesson, short_lesson, two_rounds

ROOT = Path(__file__).parents[3]
LESSONS = ROOT / "app" / "protocol" / "lessons"


def test_no_lesson_has_more_than_ninety_words_in_sight_in_any_state(subtests: pytest.Subtests) -> None:
    assert MOST_WORDS == 90
    for lesson in catalogue():
        with subtests.test(lesson.name):
            assert wordy_states(lesson) == []


def test_each_text_counts_in_the_states_that_show_it(subtests: pytest.Subtests) -> None:
    """Ten words more of it are ten words more there."""
    ten, plain = " and" * 10, words_in_sight(short_lesson())
    look = {"at": "map", "words": "It."}
    for field, longer, states in (
        ("title", {"title": "A short lesson" + ten}, set(plain)),
        ("text", {"text": "The robot drives." + ten}, set[str]()),
        ("outcome", {"outcome": "It drove {path_m}." + ten}, {"compared"}),
        ("because", {"because": "The wheels turned." + ten}, {"compared"}),
        ("watch", {"watch": [{**look, "words": "It." + " and" * 8}]}, {"showing"}),  # and the name of the plate
        ("sandbox", {"sandbox": [{"words": ten.strip()}]}, {"sandbox"}),
    ):
        with subtests.test(field):
            now = words_in_sight(short_lesson(**longer))
            assert {state: now[state] - plain[state] for state in plain} == {
                state: 10 if state in states else 0 for state in plain
            }


def test_a_plan_and_rounds_have_words_of_their_own() -> None:
    plain, drawn, rounds = (words_in_sight(lesson) for lesson in (short_lesson(), drawn_lesson(), two_rounds()))
    assert drawn["compared"] > plain["compared"]
    assert set(rounds) - set(plain) == {"between rounds"}
    assert count_words(["3 x 4 cells · 40 % (odometry)"]) == 6


def test_the_card_s_own_words_are_those_of_the_page() -> None:
    page = (ROOT / "web" / "static" / "index.html").read_text("utf-8")
    page += "".join(path.read_text("utf-8") for path in (ROOT / "web" / "static" / "lessons").glob("*.js"))
    texts = [text for part in CARD.values() for text in part]
    pieces = [piece.strip() for text in texts for piece in re.split(r"\d+|ADDRESS\.", text)]
    assert [piece for piece in pieces if piece not in page] == []


@pytest.mark.slow
def test_one_that_is_longer_is_right_and_says_where(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (LESSONS / "01-packet.toml").read_text("utf-8")
    path = tmp_path / "long.toml"
    for long, said in (("", ""), (" again and" * 20, "in the state 'compared' the card shows 1")):
        path.write_text(text.replace("9 layers up.", f"9 layers up.{long}"))
        assert cli.main(["lessons", "--check", str(path)]) == 0
        out = capsys.readouterr().out
        assert "all is right" in out
        assert said in out
        assert out.count("shorten") == bool(long)

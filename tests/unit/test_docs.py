"""The documentation is tested: its examples are run, and its names and links are looked up."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest

from app.config import Config, additions_markdown, to_markdown
from app.protocol import measures

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.glob("*.md"))
ROOMS = ("app", "disk", "ratslam_core", "sim2d", "web")


def blocks(page: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def test_the_ten_lines_find_the_robot(capsys: pytest.CaptureFixture[str]) -> None:
    example = blocks("engine.md")[0]
    assert len([line for line in example.splitlines() if line]) <= 10
    names: dict[str, Any] = {}
    exec(example, names)
    brain, place = names["brain"], names["place"].pose_map_robot
    assert f"{len(brain.local_view)} views, {len(brain.experience_map)} experiences" in capsys.readouterr().out
    lap, angle = 2 * math.pi / (0.2094 * 0.1), 0.2094 * 0.1 * 899
    assert math.dist((place.x, place.y), (1.5 * math.sin(angle), 1.5 * (1 - math.cos(angle)))) < 0.4
    assert len(brain.experience_map) < lap / 2  # three laps, and hardly more places than in one


def test_the_other_examples_run() -> None:
    for example in blocks("engine.md")[1:]:
        exec(example, {"__name__": "a_users_file"})


def test_the_tables_are_those_of_the_program() -> None:
    for page, table, option in (
        ("parameters.md", to_markdown(Config()), "--table"),
        ("additions.md", additions_markdown(), "--additions"),
        ("measures.md", measures.to_markdown(), "--measures"),
    ):
        assert (DOCS / page).read_text(encoding="utf-8") == table, (
            f"docs/{page} is old: make it anew with `ratslam config {option} > docs/{page}`"
        )


def test_links_lead_somewhere() -> None:
    links = [(page.name, to) for page in PAGES for to in re.findall(r"\]\(([^)#\s]+)", page.read_text("utf-8"))]
    assert links
    assert [(page, to) for page, to in links if not (to.startswith("http") or (DOCS / to).exists())] == []


def test_every_test_that_is_named_exists() -> None:
    """Tests named in docstrings and documents exist: files, and functions with or without their file."""
    tests = list((ROOT / "tests").rglob("test_*"))
    there = {path.name.split(".")[0] for path in tests} | {"test_x"}
    for path in (path for path in tests if path.suffix == ".py"):
        there |= set(re.findall(r"^ *(?:async )?def (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE))
    files = [*PAGES, *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]
    named = {(path.name, word) for path in files for word in re.findall(r"\btest_\w+", path.read_text("utf-8"))}
    assert {(name, word) for name, word in named if word not in there} == set()
    for page in PAGES:
        for name, words in re.findall(r"`([\w/]+\.test\.js)::([^`]+)`", page.read_text("utf-8")):
            assert f'test("{words}"' in (ROOT / "tests" / name).read_text("utf-8"), f"{page.name}: {name}::{words}"


def test_every_file_that_a_document_names_exists() -> None:
    """By its path, or by its name alone."""
    paths = [path.relative_to(ROOT) for room in (*ROOMS, "tests", "benchmarks") for path in (ROOT / room).rglob("*.*")]
    there = {name for path in paths for name in (path.name, str(path), str(path).split("/", 1)[-1])}
    named = {
        (page.name, name) for page in PAGES for name in re.findall(r"`([\w/.-]+\.(?:py|js))`", page.read_text("utf-8"))
    }
    assert {(page, name) for page, name in named if name not in there} == set()

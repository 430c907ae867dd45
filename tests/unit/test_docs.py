"""The documentation is tested: its examples are run, and its names and links are looked up."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest

from app.config import Config, additions_markdown, to_markdown

DOCS = Path(__file__).parents[2] / "docs"
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


def test_the_table_of_parameters_is_that_of_the_program() -> None:
    assert (DOCS / "parameters.md").read_text(encoding="utf-8") == to_markdown(Config()), (
        "docs/parameters.md is old: make it anew with `ratslam config --table > docs/parameters.md`"
    )


def test_the_table_of_additions_is_that_of_the_program() -> None:
    assert (DOCS / "additions.md").read_text(encoding="utf-8") == additions_markdown(), (
        "docs/additions.md is old: make it anew with `ratslam config --additions > docs/additions.md`"
    )


@pytest.mark.parametrize("page", sorted(p.name for p in DOCS.glob("*.md")))
def test_links_lead_somewhere(page: str) -> None:
    for target in re.findall(r"\]\(([^)#\s]+)", (DOCS / page).read_text(encoding="utf-8")):
        assert target.startswith("http") or (DOCS / target).exists(), f"{page}: {target}"


ROOT = DOCS.parent


def test_every_test_that_is_named_exists() -> None:
    """Tests named in docstrings and documents exist: files, and functions with or without their file."""
    tests = list((ROOT / "tests").rglob("test_*"))
    there = {path.name.split(".")[0] for path in tests} | {"test_x"}
    for path in (path for path in tests if path.suffix == ".py"):
        there |= set(re.findall(r"^ *(?:async )?def (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE))
    files = [*DOCS.glob("*.md"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))]
    words = {
        (path.name, word) for path in files for word in re.findall(r"\btest_\w+", path.read_text(encoding="utf-8"))
    }
    assert {(name, word) for name, word in words if word not in there} == set()
    for page in DOCS.glob("*.md"):
        for name, words_of in re.findall(r"`([\w/]+\.test\.js)::([^`]+)`", page.read_text("utf-8")):
            assert f'test("{words_of}"' in (ROOT / "tests" / name).read_text("utf-8"), (
                f"{page.name}: {name}::{words_of}"
            )


def test_every_file_that_a_document_names_exists() -> None:
    """By its path, or by its name alone."""
    paths = [path for room in (*ROOMS, "tests", "benchmarks") for path in (ROOT / room).rglob("*.*")]
    there = {path.name for path in paths} | {str(path.relative_to(ROOT)) for path in paths}
    ends = {str(path.relative_to(ROOT)).split("/", 1)[-1] for path in paths}
    named = {
        (page.name, name)
        for page in DOCS.glob("*.md")
        for name in re.findall(r"`([\w/.-]+\.(?:py|js))`", page.read_text("utf-8"))
    }
    assert {(page, name) for page, name in named if name not in there | ends} == set()

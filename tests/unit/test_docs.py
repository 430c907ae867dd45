"""What the documentation says is run."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest

from app.config import Config, to_markdown

DOCS = Path(__file__).parents[2] / "docs"


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
        exec(example, {})


def test_the_table_of_parameters_is_that_of_the_program() -> None:
    assert (DOCS / "parameters.md").read_text(encoding="utf-8") == to_markdown(Config()), (
        "docs/parameters.md is old: make it anew with `ratslam config --table > docs/parameters.md`"
    )


@pytest.mark.parametrize("page", sorted(p.name for p in DOCS.glob("*.md")))
def test_links_lead_somewhere(page: str) -> None:
    for target in re.findall(r"\]\(([^)#\s]+)", (DOCS / page).read_text(encoding="utf-8")):
        assert target.startswith("http") or (DOCS / target).exists(), f"{page}: {target}"

"""The parts of docs/engine.md, handed in: the closed loop runs with each, twice the same, and goes on from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.config import Config
from app.headless import run_headless
from ratslam_core import RatSlam, load_brain, save_brain
from sim2d import SONAR_ANGLES_RAD, load_world
from tests.unit.ratslam_core.drives import Circle
from tests.unit.test_docs import blocks

PARTS = {"StepsOfGrey": "local_view", "LeastSquares": "optimiser", "DenseCells": "pose_cells"}


def made(name: str) -> dict[str, Any]:
    """The names of the example that defines a class. Each file has its own module, as a user's has."""
    example = next(block for block in blocks("engine.md") if f"class {name}" in block)
    names: dict[str, Any] = {"__name__": "a_users_file"}
    exec(example, names)
    return names


def brain_with(name: str, **more: Any) -> RatSlam:
    """The brain as the example makes it, but with sonars."""
    brain = made(name)["brain"]
    part = brain.experience_map.optimiser if name == "LeastSquares" else getattr(brain, PARTS[name])
    return RatSlam(brain.params, np.random.default_rng(3), **{PARTS[name]: part}, **more)


@pytest.mark.slow
@pytest.mark.parametrize("name", PARTS)
def test_the_loop_runs_with_it_twice_alike_and_goes_on_from_its_file(name: str, tmp_path: Path) -> None:
    circle, brain = Circle(1), brain_with(name)
    circle.advance(brain, 340)
    assert brain.experience_map.closures > 0
    assert circle.miss_m(circle.advance(brain, 1)[0]) < 1.0
    save_brain(brain, tmp_path / "brain.npz")
    copy, here = load_brain(tmp_path / "brain.npz"), circle.angle
    assert copy.digest() == brain.digest()
    circle.advance(brain, 40)
    circle.angle = here
    circle.advance(copy, 40)
    assert copy.digest() == brain.digest()

    reports = []
    for _ in range(2):
        brain = brain_with(name, sonar_angles_rad=SONAR_ANGLES_RAD)
        config = replace(Config(), pose_cells=brain.params.pose_cells)
        reports.append(run_headless(load_world(), 1, 0.5, config=config, brain=brain, goals=1))
    assert reports[0]["state_hash"] == reports[1]["state_hash"]
    assert reports[0]["experiences"] > 20


def test_a_part_of_a_class_without_a_kind_is_told_how_it_gets_one() -> None:
    class Mine:
        params = None

        def correct(self, map_: object) -> None:
            """Changes nothing."""

    with pytest.raises(TypeError, match=r'must not hold a .*Mine: name its class with @kind\("name/1"\)'):
        RatSlam(optimiser=Mine()).digest()


def test_what_a_part_says_of_itself_is_a_law(tmp_path: Path) -> None:
    def check(_self: object) -> None:
        raise ValueError("least squares were never solved")

    names = made("LeastSquares")
    save_brain(names["brain"], tmp_path / "brain.npz")
    names["LeastSquares"].check = check
    said = r"brain\.npz is no brain that can be taken back: least squares were never solved"
    with pytest.raises(ValueError, match=said):
        load_brain(tmp_path / "brain.npz")

"""One trial of the 2006 study, by its own two numbers: whoever is to see has a camera, whoever reads numbers has none."""

from __future__ import annotations

from itertools import product

import pytest

from app.cli.trial import SizeAndAmbiguity
from app.config import Config
from app.protocol.experiment import EngineName

ENGINES: list[EngineName] = ["paper", "ours"]


def test_the_camera_is_on_for_a_brain_that_looks(subtests: pytest.Subtests) -> None:
    for engine, sees in product(ENGINES, (True, False)):
        with subtests.test(f"{engine}, camera {sees}"):
            trial = SizeAndAmbiguity(16, 4.0, "camera" if sees else "scene", engine, 9).trial
            config = Config().with_values(trial.values)
            assert config.robot.camera is sees
            assert (config.local_view.front_end == "scene numbers") is not sees
            assert (config.pose_cells.n_x, config.pose_cells.n_y, trial.seed) == (16, 16, 9)
            assert config.local_view.false_positives == pytest.approx(0.04)
            assert bool(trial.begin().session.frame.image.any()) is sees
    assert SizeAndAmbiguity(64, 0.0, "scene", "paper", 20060).trial.values.items() >= {
        "local_view.learning_rate": 0.015, "pilot.seek": True, "experience_map.sweep": "by experience",
    }.items()  # fmt: skip

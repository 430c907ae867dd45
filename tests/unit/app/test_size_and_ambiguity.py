"""One trial of the 2006 study, by its own two numbers: whoever is to see has a camera, whoever reads numbers has none."""

from __future__ import annotations

import pytest

from app.config import Config
from app.trials.experiment import EngineName
from app.trials.size_and_ambiguity import SizeAndAmbiguity


@pytest.mark.parametrize("engine", ["paper", "ours"])
@pytest.mark.parametrize("sees", [True, False])
def test_the_camera_is_on_for_a_brain_that_looks(engine: EngineName, sees: bool) -> None:
    vision = "camera" if sees else "scene"
    trial = SizeAndAmbiguity(16, 4.0, vision, engine, 9).trial
    config = Config().with_values(trial.values)
    assert config.robot.camera is sees
    assert (config.local_view.front_end == "scene numbers") is not sees
    assert (config.pose_cells.n_x, config.pose_cells.n_y) == (16, 16)
    assert config.local_view.false_positives == pytest.approx(0.04)
    assert trial.seed == 9
    image = trial.begin().session.frame.image
    assert bool(image.any()) is sees


def test_the_papers_trial_by_scene_numbers_is_that_of_its_table() -> None:
    assert SizeAndAmbiguity(64, 0.0, "scene", "paper", 20060).trial.values.items() >= {
        "local_view.learning_rate": 0.015, "pilot.seek": True, "experience_map.sweep": "by experience",
    }.items()  # fmt: skip

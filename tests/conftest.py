"""Settings for all tests: none depends on how fast the machine is, and each run of the suite tries the same examples."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

SLOW = [HealthCheck.too_slow, HealthCheck.large_base_example]
settings.register_profile("suite", deadline=None, derandomize=True, print_blob=True, suppress_health_check=SLOW)
settings.register_profile("hunt", settings.get_profile("suite"), derandomize=False)  # --hypothesis-profile=hunt: others
settings.register_profile("everyday", settings.get_profile("suite"), max_examples=40)  # of 100
settings.load_profile("suite")

# A shell lets what it starts in the background ignore Ctrl+C, and so would every program that a test starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def _a_home_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Nothing is read from what a person has kept, and nothing is left in their home."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RATSLAM_RUNS", str(tmp_path_factory.mktemp("kept") / "runs"))
        patch.setenv("RATSLAM_WORLDS", str(tmp_path_factory.mktemp("kept") / "worlds"))
        yield

"""The suite's own patience: an example may take as long as a busy machine needs."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests import patience


@settings(max_examples=2)
@given(st.booleans())
def test_a_slow_example_is_no_failure(wait: bool) -> None:
    time.sleep(0.25 * wait)  # longer than hypothesis allows unless it is told otherwise


def test_what_comes_late_is_found_and_what_never_comes_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = iter([None, 0, "there"])
    assert patience.until(lambda: next(looks)) == "there"
    monkeypatch.setattr(patience, "PATIENCE_S", 0.0)
    with pytest.raises(AssertionError, match="not within 0 s: the robot's return"):
        patience.until(lambda: None, "the robot's return")

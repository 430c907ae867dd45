"""Benches for the tests of the viewer."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench


@pytest.fixture(scope="module")
def shared() -> Iterator[Bench]:
    """One bench for all tests of a file; to set one up takes a while."""
    bench = Bench()
    yield bench
    bench.viewer.stop()


@pytest.fixture
def bench() -> Iterator[Bench]:
    """A new bench that has drawn one snapshot."""
    made = Bench()
    made.show(fake_snapshot(430), 10.0)
    made.settle()
    yield made
    made.viewer.stop()

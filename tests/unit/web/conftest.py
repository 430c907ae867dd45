"""Benches for the tests of the viewer, and a server for those of routes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.doubles import House, StubEngine, house
from web.messages import Snapshot


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


@pytest.fixture
def moment() -> Snapshot:
    """What `stage` shows, for a file of tests to say."""
    return fake_snapshot(430)


@pytest.fixture
def stage(shared: Bench, moment: Snapshot) -> Bench:
    """The bench that a file shares, as if new: one moment is drawn, and nobody has done anything."""
    shared.show(moment, 10.0)
    shared.settle()
    for noted in (shared.engine.commands, shared.engine.answers, shared.complaints, shared.told):
        noted.clear()
    return shared


@pytest.fixture
def parts() -> dict[str, Any]:
    """What app hands over to the server, for a file of tests to say."""
    return {}


@pytest.fixture
def served(parts: dict[str, Any]) -> Iterator[House]:
    with house(**parts) as made:
        yield made


@pytest.fixture
def engine(served: House) -> StubEngine:
    return served.engine


@pytest.fixture
def client(served: House) -> TestClient:
    return served.client

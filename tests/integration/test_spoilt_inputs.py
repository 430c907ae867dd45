"""A small share of what `python -m tests.fuzz` does by the thousand: spoilt files and messages with fixed seeds.

They run in a process of their own, since the faults that are looked for may end it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest

from tests.fuzz.__main__ import MOST_MIB, SOUND, Worker
from tests.fuzz.inputs import KINDS
from tests.fuzz.messages import MESSAGES

SHARES = {
    "brain state": 60,
    "brain file": 10,
    "session state": 60,
    "session file": 10,
    "recording": 150,
    "run": 40,
    "messages": 3,
    "requests": 2,
}


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    with contextlib.closing(Worker()) as made:
        yield made


@pytest.mark.parametrize("kind", [*KINDS, *MESSAGES])
def test_whatever_is_spoilt_is_taken_or_refused_in_a_sentence(worker: Worker, kind: str) -> None:
    outcomes = set()
    for seed in range(SHARES.get(kind, 25)):
        answer = worker.ask(kind, seed)
        assert answer["outcome"] in SOUND, f"{kind}, seed {seed}: {answer['outcome']}\n{answer['words']}"
        assert int(str(answer["mib"])) < MOST_MIB
        outcomes.add(answer["outcome"])
    assert outcomes == {"taken"} if kind in MESSAGES else "refused" in outcomes

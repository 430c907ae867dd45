"""Faults of the whole: what a person would notice (faults.toml)."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.mutants.operators import Mutant


@dataclass(frozen=True)
class Fault:
    """One change of one place in the program, and the tests that notice it."""

    name: str
    file: str
    before: str
    after: str
    tests: tuple[str, ...] = ()

    def mutant(self, root: Path) -> Mutant:
        """Where it is now. ValueError: the code is another by now."""
        source, before = (root / self.file).read_bytes(), self.before.encode()
        if source.count(before) != 1:
            raise ValueError(
                f"{self.name}: {self.file} has {self.before!r} {source.count(before)} times, expected once"
            )
        start = source.index(before)
        line = source.count(b"\n", 0, start) + 1
        return Mutant(self.file, line, start, start + len(before), self.before, self.after)


def faults() -> list[Fault]:
    text = Path(__file__).with_name("faults.toml").read_text(encoding="utf-8")
    tables: list[dict[str, Any]] = tomllib.loads(text)["fault"]
    return [Fault(tests=tuple(table.pop("tests", ())), **table) for table in tables]

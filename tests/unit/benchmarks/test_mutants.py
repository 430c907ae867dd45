"""Small faults and faults of the whole: each is a program that differs from ours in one place."""

from __future__ import annotations

import ast
from pathlib import Path

from benchmarks.mutants.faults import faults
from benchmarks.mutants.operators import mutants_of

ROOT = Path(__file__).parents[3]


def test_a_fault_of_the_whole_is_one_place_of_the_program_that_there_is() -> None:
    for fault in faults():
        mutant = fault.mutant(ROOT)
        source = (ROOT / mutant.file).read_bytes()
        changed = source[: mutant.start] + mutant.after.encode() + source[mutant.end :]
        assert changed != source, fault.name
        if mutant.file.endswith(".py"):
            ast.parse(changed)
            assert fault.tests, fault.name
        for test in fault.tests:
            file, _, function = test.partition("::")
            assert f"def {function}" in (ROOT / file).read_text(encoding="utf-8"), f"{fault.name}: {test}"


def test_what_a_file_can_have_wrong(tmp_path: Path) -> None:
    for name, text, changed in (
        ("a.py", "if not x:\n    f(a - b)", ["(x)", "pass", "(a + b)"]),
        ("a.py", "y = np.minimum(a, b) if a in b else 'é' + c", ["(a not in b)", "(np.maximum(a, b))", "('é' - c)"]),
        ("a.py", "def f(a: int | None) -> str | int:\n    raise ValueError(a + 1)", []),
        ("a.js", "if (x) f(a - b);", ["(!(x))", ";", "+"]),
        ("a.js", "const y = Math.min(a, 'é') ?? 2;\nreturn y === 1;", ["&&", "Math.max", "return undefined;", "!=="]),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
        found = list(mutants_of(tmp_path, tmp_path / name))
        assert sorted(m.after for m in found) == sorted(changed)
        assert all(text.encode()[m.start : m.end].decode() == m.before for m in found)

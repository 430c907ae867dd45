"""Which version of the program decides a trial: a digest of the code that does, comments and docstrings left aside."""

from __future__ import annotations

import ast
import hashlib
import threading
from functools import cache
from pathlib import Path

_ROOT = Path(__file__).parents[1]
_DECIDES = (
    "ratslam_core",
    "sim2d",
    "app/session.py",
    "app/sources",
    "app/sensor_input.py",
    "app/pilot",
    "app/config",
    "app/evaluation",
    "app/protocol/steps.py",
    "app/protocol/course.py",
    "app/protocol/measures.py",
    "app/protocol/trial.py",
)


_ONE_AT_A_TIME = threading.Lock()


def code_version() -> str:
    """Twelve hexadecimal digits. Equal trials have equal scores while these are equal."""
    with _ONE_AT_A_TIME:  # up to Python 3.12 ast.parse raises SystemError while another thread is in it
        return _digest()


@cache
def _digest() -> str:
    digest = hashlib.sha256()
    for room in _DECIDES:
        path = _ROOT / room
        for file in [path] if path.suffix else sorted(path.rglob("*.py")):
            digest.update(file.relative_to(_ROOT).as_posix().encode())
            digest.update(_meaning(file.read_text(encoding="utf-8")).encode())
    return digest.hexdigest()[:12]


def _meaning(text: str) -> str:
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and _is_told(node):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.dump(tree)


def _is_told(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    first = node.body[0] if node.body else None
    return isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str)

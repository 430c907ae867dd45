"""Who imports whom, in a small program made up for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.ways import circles, importers, modules

FILES = {
    "app/__init__.py": "",
    "app/a.py": "from app.house import Door\nimport app.b",
    "app/b.py": "from app import c",
    "app/c.py": "try:\n    from app.a import x\nfinally: pass",
    "app/house/__init__.py": "import lazy_loader",
    "app/house/__init__.pyi": "from .door import Door",
    "app/house/door.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from app.house.key import Key",
    "app/house/key.py": "from app.house.door import Door\ndef turn():\n    import app.house.lock",
    "app/house/lock.py": "from .key import turn",
}


@pytest.fixture
def known(tmp_path: Path) -> dict[str, Path]:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return modules(tmp_path, ("app",))


def test_a_circle_is_of_what_is_loaded_not_of_types_or_of_what_a_function_imports(known: dict[str, Path]) -> None:
    assert circles(known) == {frozenset({"app.a", "app.b", "app.c"})}


def test_who_takes_a_name_from_the_face_of_a_package_imports_the_file_behind_it(known: dict[str, Path]) -> None:
    found = importers(known)
    assert found["app.house.door"] == {"app.a", "app.house.key"}
    assert found["app.house.key"] == {"app.house.door", "app.house.lock"}
    assert (found["app.house.lock"], found["app.c"]) == ({"app.house.key"}, {"app.b"})

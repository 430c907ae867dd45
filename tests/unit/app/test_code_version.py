"""The version of the program, asked for by several threads at once, as at a start with a page already open."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest

from app.trials import code_version as module


@pytest.mark.slow
def test_it_is_made_once_however_many_ask(monkeypatch: pytest.MonkeyPatch) -> None:
    """CPython up to 3.12: ast.parse raises SystemError while another thread is in it (its issue 106905)."""
    began, read = Barrier(4), list[str]()
    meaning = module._meaning
    monkeypatch.setattr(module, "_meaning", lambda text: (read.append(text), meaning(text))[1])
    module._digest.cache_clear()

    def ask(_: int) -> str:
        began.wait()
        return module.code_version()

    with ThreadPoolExecutor(4) as pool:
        answers = set(pool.map(ask, range(4)))
    assert len(answers) == 1
    assert len(read) == len(set(read))

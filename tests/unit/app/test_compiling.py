"""Compiling ahead: after the parts, a real run has nothing left to compile; and when they are run at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest

from app.startup import compiling
from app.startup.compiling import PARTS, Compiling, date, is_compiled, kept
from ratslam_live import command_of
from tests.patience import PATIENCE_S

# Which kernels have been used for which types, and which of their files have been opened: before and after a real run.
LEFT_OVER = """
import sys
from numba.core.dispatcher import Dispatcher
from app.config import Config
from app.engine_thread import EngineThread
from app.headless import run_headless
from app.startup.compiling import Compiling
from app.startup.compiling import EngineStarter
from sim2d import load_world
from web import messages as m

def used():
    rooms = [module for name, module in list(sys.modules.items()) if name.startswith(("app.", "sim2d.", "ratslam_core."))]
    kernels = {item for module in rooms for item in vars(module).values() if isinstance(item, Dispatcher)}
    return {(kernel.py_func.__qualname__, str(types)) for kernel in kernels for types in kernel.signatures}

engine, opened = EngineThread(load_world(), 5, Config(), speed=0.0), []
starter = EngineStarter(engine, Compiling())
starter.start()
version, _ = engine.latest.wait(0, 600.0)
before = used()
sys.addaudithook(lambda event, args: opened.append(args[0]) if event == "open" and ".nb" in str(args[0])[-4:] else None)
for order in (m.Kidnap(type="kidnap"), m.SetGoal(type="set_goal", x=0.0, y=0.0), m.Tag(type="tag", name="here")):
    engine.submit(order).result(60)
run_headless(load_world(), 5, 1.0)
while version < 5:  # and what the page is shown
    version, _ = engine.latest.wait(version, 60.0)
starter.stop()
print(len(before) > 40, sorted(used() - before), opened)
"""


@pytest.mark.slow
def test_once_it_is_awake_a_run_has_nothing_to_compile_and_no_kernel_to_load() -> None:
    """Whoever connects may take the last descriptor: the engine once stopped at its first kernel after that."""
    done = subprocess.run([sys.executable, "-c", LEFT_OVER], capture_output=True, text=True, timeout=600, check=True)
    assert done.stdout == "True [] []\n"


def test_a_module_is_compiled_when_a_kernel_of_it_is_kept_that_is_not_older_or_was_found_to_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "ahead.py").write_text("from numba import njit\n@njit(cache=True)\ndef one():\n    return 1\n")
    monkeypatch.delitem(sys.modules, "ahead", raising=False)
    import ahead  # type: ignore[import-not-found]

    assert not is_compiled(ahead)
    assert ahead.one() == 1
    assert is_compiled(ahead)
    for index in kept(ahead):
        os.utime(index, (1e9, 1e9))  # the source was touched since
    assert not is_compiled(ahead)
    date([ahead])
    assert is_compiled(ahead)


def test_only_what_is_missing_is_compiled_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    missing, really = PARTS["cells"][1], subprocess.Popen
    commands, told = list[list[str]](), list[str]()

    def begin(command: list[str], **options: Any) -> subprocess.Popen[str]:
        commands.append(command)
        return really([sys.executable, "-c", "print(); print()"], **options)

    monkeypatch.setattr(compiling, "is_compiled", lambda module: module not in missing)
    monkeypatch.setattr(subprocess, "Popen", begin)
    work = Compiling()
    work.wait(told.append)
    work.stop()
    assert work
    assert commands == [command_of("app.startup.compiling", "cells")]
    assert told == [f"{compiling.WORDS}: {words} done" for words in ("1 function", "2 functions")]
    monkeypatch.setattr(compiling, "is_compiled", lambda _module: True)
    assert not Compiling()


@pytest.mark.slow
def test_each_part_has_a_process_of_its_own_and_all_can_be_stopped_at_any_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiling, "is_compiled", lambda _module: False)
    before, began = psutil.Process().children(recursive=True), list[psutil.Process]()
    work = Compiling()

    def stop_at_the_first_kernel(_words: str) -> None:
        if not began:
            began.extend(child for child in psutil.Process().children(recursive=True) if child not in before)
            work.stop()

    work.wait(stop_at_the_first_kernel)
    assert len(began) == 1 + len(PARTS)
    _, alive = psutil.wait_procs(began, timeout=PATIENCE_S)
    assert alive == []

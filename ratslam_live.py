"""What must be so before any of our packages is used, whoever begins: the command `ratslam`, its processes, a notebook.

`app`, `web` and `disk` are names that others use, too. A notebook beside its own `app.py`, or a shell whose PYTHONPATH brings
one, gets ours all the same once this is imported, as the packages that have kernels do first.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path

ROOMS = ("app", "benchmarks", "disk", "ratslam_core", "sim2d", "web")
_MMAP_THRESHOLD = -3  # as <malloc.h> has it
_ROOT = Path(__file__).resolve().parent


def main() -> int:
    """The command `ratslam`. Its exit code."""
    _own_environment_first()
    from app.__main__ import main as command

    return command()


def command_of(module: str, *words: str) -> list[str]:
    """What starts a module of ours in a process of its own, with these words."""
    return [sys.executable, "-P", __file__, "-m", module, *words]


class _Rooms:
    """Finds our packages beside this file before anybody looks for them elsewhere."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> ModuleSpec | None:  # noqa: ARG004
        return PathFinder.find_spec(name, [str(_ROOT)]) if name in ROOMS else None


def _rooms_first() -> None:
    """ImportError: somebody has loaded a package of the same name already."""
    for name in ROOMS:
        file = getattr(sys.modules.get(name), "__file__", None)
        if file is not None and _ROOT not in Path(file).resolve().parents:
            raise ImportError(f"another {name!r} is loaded already ({file}); write `import ratslam_live` before it")
    sys.meta_path.insert(0, _Rooms)


def _own_environment_first() -> None:
    """What PYTHONPATH adds (a sourced ROS, another Python's packages) is looked at last, unless the program itself lies there."""
    added = [os.path.abspath(path) for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]
    if str(_ROOT) not in map(os.path.realpath, added):
        sys.path.sort(key=lambda path: os.path.abspath(path) in added)


def _give_back_at_once() -> None:
    """What is freed goes back to the system in pieces of a MiB and more. glibc keeps ever larger ones for later, and after hours
    of driving an eighth of all memory was such. test_machines.py::test_a_large_array_that_is_freed_goes_back_to_the_system."""
    with contextlib.suppress(OSError, AttributeError):  # another C library knows no such thing
        ctypes.CDLL(None).mallopt(_MMAP_THRESHOLD, 1 << 20)


_rooms_first()
_give_back_at_once()
from disk import kernel_cache  # noqa: E402 - ours, from here on

kernel_cache.choose()

if __name__ == "__main__":
    sys.modules["ratslam_live"] = sys.modules["__main__"]
    if sys.argv[1:2] == ["-m"]:
        import runpy

        _own_environment_first()
        del sys.argv[:2]
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
    else:
        sys.exit(main())

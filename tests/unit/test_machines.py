"""The program starts for any user in any home, beside whatever else has the names of its packages; commands that need no kernel
load none."""

from __future__ import annotations

import json
import os
import platform
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from app.config import Config, from_toml
from disk import kernel_cache
from tests.recordings import image_folder
from tests.unit.app.run_record.kept import keep_one

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
RATSLAM = Path(sys.executable).with_name("ratslam")
WITHOUT_KERNELS = """
--help; runs; runs --json; config; config --table; worlds; lessons; experiment; run --help; runs --help; replay --help;
headless --help; deliver --help; trial --help; experiment --help; lessons --help; export --help; worlds --help;
recording check --help; config --help; bench --help
"""
HEAVY = ("numba", "viser", "scipy", "distributed", "dask", "matplotlib", "cv2", "pymunk", "fastapi", "PIL")
LAW = """
import contextlib, io, json, sys
from app.cli.command_line import main
for words in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        try:
            code = main(words)
        except SystemExit as end:
            code = end.code
    assert code == 0 and printed.getvalue(), (words, code)
    loaded = sorted(set(json.loads(sys.argv[2])) & set(sys.modules))
    assert not loaded, f"{words} loads {loaded}"
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="others hold nothing back")
def test_a_large_array_that_is_freed_goes_back_to_the_system() -> None:
    """After one of 30 MB, glibc would take those of 20 MB from its heap, where what is allocated later holds them."""
    held = """
import sys
if sys.argv[1] == "ours":
    import ratslam_live
import numpy, psutil
large = numpy.ones(30 << 17)
del large
before, small = psutil.Process().memory_info().rss, []
for _ in range(5):
    large = numpy.ones(20 << 17)
    small.append(numpy.ones(1000))
    del large
print((psutil.Process().memory_info().rss - before) >> 20)
"""
    mb = {
        whose: int(
            subprocess.run([sys.executable, "-c", held, whose], capture_output=True, check=True, cwd=ROOT).stdout
        )
        for whose in ("ours", "usual")
    }
    assert mb["ours"] < 5 < 15 < mb["usual"]


def test_commands_that_need_no_kernel_load_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep_one(tmp_path, monkeypatch, ticks=20)  # to be listed
    commands = [words.split() for words in WITHOUT_KERNELS.split(";")]
    done = subprocess.run(
        [sys.executable, "-c", LAW, json.dumps(commands), json.dumps(HEAVY)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    shown = subprocess.run([RATSLAM, "--help"], capture_output=True, text=True, check=True).stdout
    verbs = set(shown.partition("{")[2].partition("}")[0].split(","))
    assert {words[0] for words in commands} > verbs, "a new command belongs into this list"


# ------------------------------------------------------------ environments

FOREIGN = ("app", "benchmarks", "disk", "ratslam_core", "sim2d", "web")
NO_LOCKS = """
#include <errno.h>
int flock(int file, int how) { errno = ENOLCK; return -1; }
int lockf(int file, int how, long size) { errno = ENOLCK; return -1; }
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """An empty folder to begin the program in. Everybody may write there, as in /tmp."""
    folder = tmp_path / "place"
    folder.mkdir()
    folder.chmod(0o777)
    return folder


def stranger() -> list[str]:
    """What a command begins with so that a user without an account does it, who may read everything and write nothing."""
    able = ["--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search"]  # or our own Python cannot be reached
    words = ["setpriv", "--reuid=54321", "--regid=54321", "--clear-groups", *able]
    if shutil.which("setpriv") is None or subprocess.run([*words, "true"], capture_output=True).returncode:
        pytest.skip("only root can begin a program as somebody else")
    return words


def foreign(folder: Path) -> str:
    """A folder with packages of the same names as ours, and an old module of a name that we need, as ROS has one."""
    for name in FOREIGN:
        (folder / name).mkdir(parents=True)
        (folder / name / "__init__.py").write_text("raise SystemExit('this is another package')\n")
    (folder / "pydantic.py").write_text("raise SystemExit('this is of another Python')\n")
    return str(folder)


def without_locks(folder: Path) -> str:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no compiler")
    (folder / "no_locks.c").write_text(NO_LOCKS)
    library = folder / "no_locks.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, folder / "no_locks.c"], check=True)
    return str(library)


ENVIRONMENTS = {
    "no account, the root as home": {"HOME": "/", "user": "stranger"},
    "no account, no home": {"HOME": None, "user": "stranger"},
    "a home that does not exist": {"HOME": "/nonexistent", "user": "stranger"},
    "a home that cannot be written": {"HOME": "{read_only}", "user": "stranger"},
    "a home that is a file": {"HOME": "{file}"},
    "an empty home": {"HOME": ""},
    "a cache that cannot be made": {"HOME": "/", "NUMBA_CACHE_DIR": "/proc/none"},
    "packages of the same names": {"PYTHONPATH": "{foreign}"},
    "a terminal of Windows": {"PYTHONIOENCODING": "cp1252"},
    "a terminal without accents": {"PYTHONIOENCODING": "ascii"},
    "a home without locks": {"HOME": "{place}", "LD_PRELOAD": "{no_locks}"},
    "nowhere to print": {"shell": ">&- 2>&-"},
}


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_it_starts(name: str, place: Path, tmp_path: Path) -> None:
    row = dict(ENVIRONMENTS[name])
    before, shell = stranger() if row.pop("user", None) else [], row.pop("shell", "")
    (tmp_path / "file").touch()
    (tmp_path / "read only").mkdir(mode=0o555)
    where = {"place": place, "file": tmp_path / "file", "read_only": tmp_path / "read only"}
    where |= {"foreign": foreign(tmp_path / "foreign")} if "PYTHONPATH" in row else {}
    where |= {"no_locks": without_locks(tmp_path)} if "LD_PRELOAD" in row else {}
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("RATSLAM_", "NUMBA_", "PYTHON"))}
    wanted = {"HOME": str(place), **row}
    environment = kept | {key: value.format(**where) for key, value in wanted.items() if value is not None}
    if wanted["HOME"] is None:
        del environment["HOME"]
    commands = " && ".join(f'"{RATSLAM}" {words} {shell}' for words in ("runs", "worlds"))
    done = subprocess.run([*before, "sh", "-c", commands], cwd=place, env=environment, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
    if not shell:
        of_the_account = name == "an empty home"  # who has worked with the program keeps runs there
        assert done.stdout.startswith((b"No run is kept", b"id ") if of_the_account else b"No run is kept")
        assert b"\noffice " in done.stdout
    assert os.listdir(place) == [], "such as a folder named ~"


def test_a_file_is_utf_8_whatever_the_terminal_is(tmp_path: Path) -> None:
    with (tmp_path / "mine.toml").open("w") as file:
        subprocess.run([RATSLAM, "config"], stdout=file, check=True, env={**os.environ, "PYTHONIOENCODING": "cp1252"})
    text = (tmp_path / "mine.toml").read_text("utf-8")
    assert "θ" in text
    assert from_toml(text) == Config()


def test_the_processes_that_it_starts_are_ours_too(tmp_path: Path) -> None:
    """The reader of recordings is one; foreign packages lie in the folder where it is called, too."""
    folder, pictures = foreign(tmp_path / "foreign"), image_folder(tmp_path / "pictures")
    for here in ({"PYTHONPATH": folder}, {}):
        done = subprocess.run(
            [RATSLAM, "recording", "check", pictures], capture_output=True, cwd=folder, env={**os.environ, **here}
        )
        assert (done.returncode, done.stderr) == (0, b"")


def test_a_notebook_beside_a_package_of_the_same_name(tmp_path: Path) -> None:
    for name in FOREIGN:
        (tmp_path / f"{name}.py").write_text("raise SystemExit('this is another module')\n")

    def python(lines: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-c", lines], cwd=tmp_path, capture_output=True, text=True)

    lines = "import ratslam_live\nfrom app.config import Config\nimport disk, sim2d, web, ratslam_core\nprint(disk.__file__)"
    done = python(lines)
    assert (done.stdout, done.stderr) == (f"{ROOT / 'disk' / '__init__.py'}\n", "")
    (tmp_path / "app.py").write_text("")
    late = python(f"import app\n{lines}").stderr
    assert "another 'app' is loaded already" in late
    assert "write `import ratslam_live` before it" in late


# ------------------------------------------------------------ kernels

KERNEL = """
from sim2d.geometry.grid_cells import connected
from disk import kernel_cache
import numpy as np
assert connected(np.ones((2, 3), bool), np.array([[0, 0]])).all()
print(kernel_cache.words)
"""
NOWHERE = """
from disk import kernel_cache
kernel_cache._may_write = kernel_cache._takes = lambda folder: False
"""


def test_a_kernel_runs_where_only_the_temporary_folder_can_be_written(place: Path) -> None:
    environment = {"HOME": "/", "TMPDIR": str(place), "PATH": os.environ["PATH"]}
    words = [*stranger(), sys.executable, "-c", KERNEL]
    for _ in range(2):
        done = subprocess.run(words, cwd="/", env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        folder = place / "ratslam-54321"
        assert f"what is compiled is kept in {folder}; NUMBA_CACHE_DIR names a better place" in done.stdout
        (index,) = folder.glob("*/*connected-*.nbi")
        assert index.stat().st_uid == 54321


def test_a_kernel_runs_where_nothing_can_be_written() -> None:
    done = subprocess.run([sys.executable, "-c", NOWHERE + KERNEL], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "the engine is compiled anew at each start; NUMBA_CACHE_DIR names a folder for it" in done.stdout


@pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")
def test_what_others_could_write_is_no_place_for_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_cache, "_TEMPORARY", ())
    for name in ("TEMP", "TMP"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    (ours,) = kernel_cache._temporary()
    assert stat.S_IMODE(ours.stat().st_mode) == 0o700
    ours.chmod(0o770)
    assert list(kernel_cache._temporary()) == []
    ours.rmdir()
    (tmp_path / "theirs").mkdir(mode=0o700)
    ours.symlink_to(tmp_path / "theirs")
    assert list(kernel_cache._temporary()) == []

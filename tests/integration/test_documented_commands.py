"""Every command line that README.md and docs/*.md show is run, and every benchmark: a documented command that does not run fails.

Each runs in a shell, with a home of its own, in a new folder, where neither is the repository's. The table below shortens what
would take long, and gives real names to PATH, FILE and ID. What it does not know is run as it stands.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
import orjson
import pytest

from app.cli.command_line import parser_of
from tests.e2e.program import Program
from tests.patience import PATIENCE_S
from tests.recordings import tub

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "sim2d").glob("*/README.md"))]
BEGINNINGS = ("ratslam ", "python -m ", "make ", "uv run")
SERVES = "--port 0 --no-browser"  # ended by Ctrl+C once it is alive
QUICK = "--quick --trials 1 --workers 1 --engine"
ONE = "ratslam experiment trial --quick --trials 1 --engine ours --workers 1"
DASK = (
    "dask scheduler --host 127.0.0.1 --port 0 --scheduler-file dask.json >scheduler.txt 2>&1 & one=$!; "
    "dask worker --scheduler-file dask.json --nworkers 1 --nthreads 1 >worker.txt 2>&1 & two=$!; "
    "until [ -s dask.json ]; do sleep 0.1; done; "
    "at=$(python -c \"import json; print(json.load(open('dask.json'))['address'])\"); "
    "ratslam experiment trial --quick --trials 1 --engine ours --scheduler $at; code=$?; "
    "kill $two $one; wait; exit $code"
)

# What is documented (a pattern of the whole line), what is run instead, and why. {0} is all of it, {1} the first group.
TABLE = (
    (r"make run(?: RUN_ARGS=\"(.*)\")?", f'make run RUN_ARGS="{{1}} {SERVES}"', "any free port"),
    (r"make (test|test-fast|test-all|coverage)", "make --dry-run {1}", "this is one of its tests: only what it would do"),
    (r"pytest (.*)", "python -m pytest --collect-only -q {1}", "that there are such tests"),
    (r"uv run ratslam", f"uv run --no-sync ratslam run {SERVES}", "without a network"),
    (r"dask .*|.*--scheduler.*", DASK, "the three lines belong together"),
    (r"ratslam run .*--situation '.*'", f"ratslam run --situation '{{link}}' {SERVES}", "a link that was made here"),
    (r"ratslam run .*--situation .*", f"ratslam run --situation {{situation}} {SERVES}", "a file that was made here"),
    (r"ratslam run .*--recording PATH|ratslam run --recording", f"ratslam run --recording {{tub}} {SERVES}", "PATH"),
    (r"ratslam run .*--resume ID", f"ratslam run --resume last {SERVES}", "ID"),
    (r"ratslam run .*--brain FILE", f"ratslam run --brain {{brain}} {SERVES}", "FILE"),
    (r"ratslam run .*--world FILE", f"ratslam run --world {{world}} {SERVES}", "FILE"),
    (r"ratslam run .*--experiment (?:NAME|table)", f"ratslam run --experiment table {SERVES}", "NAME"),
    (r"ratslam run .*--class", "{0} --class-address 127.0.0.1 --class-port 0 " + SERVES, "in no network"),
    (r"ratslam run( .*)?", "{0} " + SERVES, "any free port"),
    (r"ratslam replay(?: ID)?", "ratslam replay last", "ID"),
    (r"ratslam export (?:RUN|last) --to (?:FORMAT|mp4)", "ratslam export last --to mp4 --until 2", "RUN and FORMAT"),
    (r"ratslam headless .*--recording PATH(.*)", "ratslam headless --recording {tub}{1}", "PATH"),
    (r"ratslam headless .*--save-brain FILE", "ratslam headless --minutes 0.1 --save-brain brain.npz", "FILE"),
    (r"ratslam headless .*--world FILE", "ratslam headless --world {world} --minutes 0.1", "FILE"),
    (r"ratslam headless .*--kidnap-at.*", "ratslam headless --minutes 0.3 --kidnap-at 6 12", "not ten minutes"),
    (r"ratslam headless .*--goals 5.*", "ratslam headless --seed 200 --minutes 0.5 --goals 1", "not twenty minutes"),
    (r"ratslam headless.*", "{0} --minutes 0.1", "not twenty minutes"),
    (r"ratslam deliver.*", "{0} --minutes 0.5 --goals 2 --deliveries 1", "not a hundred"),
    (r"ratslam trial", "ratslam trial --pose-cells 8 --ambiguity 10 --seed 7", "one trial is enough"),
    (r"ratslam recording check(?: PATH)?", "ratslam recording check {tub}", "PATH"),
    (r"ratslam worlds check.*", "ratslam worlds check {world}", "FILE"),
    (r"ratslam worlds import FILE.*", "ratslam worlds import plan.png --scale 0.05 -o world.json", "FILE"),
    (r"ratslam bench", "ratslam bench --quick", "a minute"),
    (r"ratslam experiment open .*", ONE + " && ratslam experiment open {trial} --port 0", "an id of a trial run here"),
    (r"ratslam experiment my.toml", "ratslam experiment my.toml --quick --trials 1 --engine ours --workers 1", "hours"),
    (r"ratslam experiment (?:NAME|all)", "ratslam experiment all --help", "each is run by its name"),
    (r"ratslam experiment (check .*|results|)", "{0}", "as it is"),
    (r"ratslam experiment table.*", "ratslam experiment table --quick --trials 1 --engine ours --workers 1", "hours"),
    (r"ratslam experiment (?:additions|arbitration|deliveries)", "{0} " + QUICK + " ours", "hours; the papers have none"),
    (r"ratslam experiment [a-z0-9-]+", "{0} " + QUICK + " paper", "hours"),
    (r"ratslam lessons --check .*", "ratslam lessons --check {lesson}", "mine.toml is a file of parameters above"),
    (r"ratslam lessons --run(?: NAME)?", "ratslam lessons --run packet", "NAME"),
    (r"ratslam lessons --time", "ratslam lessons --help", "three minutes; every lesson is a test of its own"),
    (r"python -m sim2d.worlds.pictures .*", "python -m sim2d.worlds.pictures {here}/pictures", "not into the repository"),
    (r"python -m tests.fuzz.*", "python -m tests.fuzz --only world --count 2 && test -z \"$(ls {here} | grep fuzz)\"", "short"),
)  # fmt: skip
# Of each benchmark: the smallest arguments.
SMALLEST = {
    "alarms": "--worlds loop --minutes 0.2", "calm": "--only first-visit",
    "back_end": "--lies 10 --data {here}", "first_stage": "--times 1 --after 1",
    "evidence": "kidnaps loop --seeds 1 --minutes 0.5", "keeping": "loop 400 1",
    "exploring": "loop --minutes 0.5 --seeds 1 --workers 1",
    "killed_runs": "--count 1 --replay 1", "latency": "--count 2", "lessons": "--times 1 --no-tests",
    "days": "loop --hours 3 --minutes 1",
    "moments": "--hours 0.01 --count 3", "mutants": "--count 0", "newcomer": "74",
    "page_cost": "--seconds 1 --after 1 --only traffic", "random_drive": "--hours 0.01 loop",
    "recognition": "loop --minutes 0.5 --seeds 401 --rows {row}", "recordings": "--data {data} --only office",
    "seeking": "--hours 0.01 --count 3", "server_load": "--seconds 3", "soak": "--minutes 0.2",
    "trials": "--trials 10 --workers 1", "true_map": "office --seeds 1 --workers 1",
    "ways": "--json {here}/ways.json",
}  # fmt: skip


def documented() -> dict[str, str]:
    """Every command line that is shown, and the page that shows it."""
    found: dict[str, str] = {}
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL):
            for line in block.splitlines():
                if command := re.sub(r"\s+#\s.*", "", line).strip():
                    found.setdefault(command, page.name)
        plain = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        for code in re.findall(r"`([^`]+)`", plain):
            command = " ".join(code.split())
            if command.startswith(BEGINNINGS):
                found.setdefault(command, page.name)
    return found


COMMANDS = documented()


def instead(command: str) -> str:
    """What is run for a documented command, with {names} of what the test makes."""
    if benchmark := re.match(r"python -m benchmarks\.(\w+)", command):
        return f"python -m benchmarks.{benchmark[1]} {SMALLEST.get(benchmark[1])}"
    for pattern, run, _why in TABLE:
        if match := re.fullmatch(pattern, command):
            return run.replace("{0}", command).replace("{1}", (match[1] or "") if match.groups() else "")
    return command


MODULES = sorted(
    path.parent.name if path.name == "__main__.py" else path.stem
    for path in (*(ROOT / "benchmarks").glob("*.py"), *(ROOT / "benchmarks").glob("*/__main__.py"))
    if "__main__" in path.read_text(encoding="utf-8") and path.name != "__init__.py"
)
RUN = sorted({instead(command) for command in (*COMMANDS, *(f"python -m benchmarks.{each}" for each in MODULES))})


class Made:
    """What commands are given: a home with a run and a brain, a recording, plans and files, all made here."""

    def __init__(self, folder: Path) -> None:
        self.home, self.work = folder / "home", folder / "work"
        kept = self.home / ".ratslam"
        self.work.mkdir(parents=True)
        program = Program("--port", "0", "--seed", "5", "--speed", "0", RATSLAM_RUNS=str(kept / "runs"))
        try:
            program.wait(lambda state: state["time_s"] > 65)  # a younger brain is not kept
            moment = program.post("situation", {})
        finally:
            program.stop()
        (self.work / "a.situation.json").write_text(moment["file"], encoding="utf-8")
        data = folder / "data" / "recordings"
        data.mkdir(parents=True)
        (tub(data / "office-car") / "laps.csv").write_text("frame_later,frame_earlier\n6,0\n7,1\n", encoding="utf-8")
        plan = np.full((120, 160), 254, np.uint8)
        cv2.rectangle(plan, (4, 4), (155, 115), 0, 2)
        cv2.imwrite(str(self.work / "plan.png"), plan)
        for name, page in (("my.toml", "experiments.md"), ("lesson.toml", "lessons.md")):
            blocks = re.findall(r"```toml\n(name.*?)```", (ROOT / "docs" / page).read_text(encoding="utf-8"), re.DOTALL)
            (self.work / name).write_text(blocks[0], encoding="utf-8")
        (self.work / "mine.toml").write_text("[pilot]\ncruise_speed = 0.3\n", encoding="utf-8")
        self.names = {
            "tub": str(data / "office-car"), "data": str(data.parent), "brain": str(next((kept / "runs").glob("*/state.npz"))),
            "world": str(ROOT / "sim2d" / "worlds" / "loop.json"), "situation": "a.situation.json",
            "link": f"http://127.0.0.1:8000/#{moment['link']}", "lesson": "lesson.toml",
            "trial": "$(sed -n 2p experiments/trial/trial.csv | cut -d, -f1)",
        }  # fmt: skip


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    return Made(tmp_path_factory.mktemp("documented"))


def run(command: str, made: Made, folder: Path) -> tuple[int, str]:
    """Exit code and words of a command; a server is ended as soon as it is alive."""
    home, work = shutil.copytree(made.home, folder / "home"), shutil.copytree(made.work, folder / "work")
    in_ours = re.match(r"make |python -m |source |uv ", command)
    said: list[str] = []
    # the paths of sockets in the temporary folder must be short
    with (
        tempfile.TemporaryDirectory(prefix="docs-") as temporary,
        (home / "words").open("w+", encoding="utf-8") as words,
    ):
        for name, value in {**made.names, "here": temporary, "row": "template"}.items():
            command = command.replace(f"{{{name}}}", value)
        started = subprocess.Popen(
            ["bash", "-c", command], cwd=ROOT if in_ours else work, stdout=subprocess.PIPE, stderr=words, text=True,
            env=environment(home, Path(temporary)), start_new_session=True,
        )  # fmt: skip
        assert started.stdout is not None
        try:
            for line in started.stdout:
                said.append(line)
                if "alive at http" in line:
                    os.killpg(started.pid, signal.SIGINT)
            code = started.wait(timeout=PATIENCE_S)
        finally:
            if started.poll() is None:
                os.killpg(started.pid, signal.SIGKILL)
        words.seek(0)
        return code, "".join(said) + words.read()


def environment(home: Path, temporary: Path) -> dict[str, str]:
    """As in a terminal of somebody who has nothing yet, with the program on the path. Browsers stay where they are installed."""
    kept = {
        name: value for name, value in os.environ.items() if not name.startswith(("RATSLAM_", "DISPLAY", "WAYLAND"))
    }
    browsers = os.environ.get("PLAYWRIGHT_BROWSERS_PATH") or str(Path.home() / ".cache" / "ms-playwright")
    return {
        **kept, "HOME": str(home), "TMPDIR": str(temporary), "PLAYWRIGHT_BROWSERS_PATH": browsers,
        "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"])), "PYTHONUNBUFFERED": "1",
    }  # fmt: skip


def test_what_is_documented_is_understood() -> None:
    """Each option and value of it; that it also runs takes ten minutes."""
    wrong: list[str] = []
    for command in (each for line in RUN for each in re.findall(r"(?:^|&& |; )ratslam ([^;&|>]*)", line)):
        try:
            parser_of().parse_args(shlex.split(command) or ["run"])
        except SystemExit as end:
            wrong += [command] * (end.code != 0)
    assert wrong == []


@pytest.mark.long
@pytest.mark.parametrize("command", RUN)
def test_what_is_documented_runs(command: str, made: Made, tmp_path: Path) -> None:
    code, words = run(command, made, tmp_path)
    shown_by = [f"{each} ({page})" for each, page in COMMANDS.items() if instead(each) == command]
    assert code == 0 or ("alive at http" in words and code in (130, -signal.SIGINT)), (
        f"{shown_by}: {code}\n{words[-3000:]}"
    )
    assert "Traceback" not in words, words[-3000:]


def test_the_table_knows_nothing_else() -> None:
    """Its rows are of what is documented, and each command is run: nothing in capitals, which stands for something, is left."""
    unused = [row[0] for row in TABLE if not any(re.fullmatch(row[0], command) for command in COMMANDS)]
    assert unused == []
    assert sorted(SMALLEST) == MODULES
    assert [c for c in RUN if re.search(r"\b(FILE|PATH|ID|NAME|RUN|FORMAT)\b", c.replace("RUN_ARGS", ""))] == []


INTERRUPTED = ("recordings --data {data} --only office", "alarms --worlds loop", "killed_runs", "mutants --jobs 1")


@pytest.mark.long
@pytest.mark.parametrize("benchmark", INTERRUPTED)
def test_ctrl_c_ends_a_benchmark_in_one_line(benchmark: str, made: Made, tmp_path: Path) -> None:
    """While its libraries are being imported, where nobody would catch it: that takes most of a second."""
    command = benchmark.replace("{data}", made.names["data"]).split()
    started = subprocess.Popen(
        [sys.executable, "-m", f"benchmarks.{command[0]}", *command[1:]], cwd=ROOT, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={**environment(tmp_path, tmp_path), "PYTHONVERBOSE": "1"},
    )  # fmt: skip
    assert started.stderr is not None
    said: list[str] = []
    for line in started.stderr:  # Python tells each import
        said.append(line)
        if "import 'numpy'" in line:
            os.killpg(started.pid, signal.SIGINT)
            break
    said += started.stderr
    assert started.wait(timeout=PATIENCE_S) == 130
    assert [line for line in said if "ratslam:" in line] == ["ratslam: stopped\n"]
    assert not [line for line in said if line.startswith(("Traceback", "KeyboardInterrupt"))]


def test_results_are_made_where_they_are_asked_for(tmp_path: Path) -> None:
    for folder, words in (("docs", ""), ("a/b", "--out a/b")):
        command = f"ratslam experiment results {words}"
        subprocess.run(command, shell=True, cwd=tmp_path, check=True, env=environment(tmp_path, tmp_path))
        assert set(orjson.loads((tmp_path / folder / "results.json").read_bytes())) == {"experiments"}

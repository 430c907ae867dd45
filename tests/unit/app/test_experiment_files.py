"""Experiments as files: those that come with the program fit the worlds and parameters, and wrong ones are refused clearly."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from app.config import Config
from app.protocol.experiment import catalogue, find_experiment, names, read_experiment
from app.protocol.measures import MEASURES, Measuring, reading_of
from app.protocol.steps import Drive, Explore, Repeat, Tour, Visit, Wait
from ratslam_core.params.additions import ADDITIONS

pytestmark = pytest.mark.slow

# The experiments of the four papers, and two of ours.
ALL = {
    "hypotheses", "rates", "odometry-alone", "learning-rates", "loop", "campus", "kidnap-turn", "kidnap-far", "snaps",
    "correction", "biased-loop", "floor", "open-plan", "turn-around", "goal-memory", "two-goals", "faster-way",
    "arbitration", "table", "trial", "additions", "deliveries",
}  # fmt: skip

LEAST = """
name = "mine"
title = "Mine"
paper = "none"
asks = "Does it stand still?"
found = "Nothing."
world = "loop"
[engines.ours]
[[protocol]]
do = "wait"
seconds = 5
[[scores]]
label = "map error"
score = "error_m"
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_catalogue_is_whole_and_fits_its_worlds_and_parameters(subtests: pytest.Subtests) -> None:
    assert sorted(names()) == sorted(ALL)
    for experiment in catalogue():
        with subtests.test(msg=experiment.name):
            assert experiment.asks.endswith("?")
            assert experiment.found.endswith(".")
            experiment.check()
            trials = experiment.make_trials()
            assert len({trial.id for trial in trials}) == len(trials)


def test_every_addition_to_a_part_that_acts_is_left_out_once() -> None:
    experiment = find_experiment("additions")
    asleep = {name.removesuffix(".enabled") for name, on in experiment.set.items() if on is False}
    acting = [a for a in ADDITIONS if not all(name.split(".")[0] in asleep for name in a.off)]
    axis = next(axis for axis in experiment.axes if axis.name == "additions")
    assert [(level.label, level.set) for level in axis.levels[1:]] == [(f"without {a.name}", a.off) for a in acting]
    assert axis.levels[0].set == {}


def test_the_least_file_is_an_experiment(tmp_path: Path) -> None:
    experiment = read_experiment(written(tmp_path, LEAST))
    trials = experiment.make_trials()
    assert [trial.seed for trial in trials] == [1, 2, 3, 4, 5]
    assert {trial.levels for trial in trials} == {()}
    assert experiment.seconds() == 5.0


WRONG = [
    ('do = "wait"', 'do = "fly"', "protocol.1.*fly"),
    ("seconds = 5", "seconds = -5", "protocol.1.seconds: .*greater than 0, got -5"),
    ('score = "error_m"', "", "score 'map error': give either score = NAME or rate"),
    ('name = "mine"', 'name = "My own"', "name: .*pattern"),
    ("[engines.ours]", "[engines.mine]", "engines.mine"),
    ('title = "Mine"', 'titel = "Mine"', "title: field required"),
    ("seconds = 5", "seconds = ", "not valid TOML"),
    ("[engines.ours]", 'measures = ["beauty"]\n[engines.ours]', "measures: what the scores need is measured; leave"),
]


def test_a_wrong_file_is_refused_by_name_place_and_reason(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for wrong, right, message in WRONG:
        path = written(tmp_path, LEAST.replace(wrong, right, 1))
        said = rf"^{re.escape(str(path))}(, line \d+)?: .*{message}"
        with subtests.test(msg=right), pytest.raises(ValueError, match=said):
            read_experiment(path)
    watched = written(tmp_path, LEAST.replace("[engines.ours]", 'watch = ["9"]\n[engines.ours]', 1))
    with pytest.raises(ValueError, match="watch: 1 levels; give one of each of the 0 axes"):
        read_experiment(watched).check()
    with pytest.raises(ValueError, match=r"unknown experiment 'tabel'; expected .* one of: hypotheses"):
        find_experiment("tabel")
    with pytest.raises(ValueError, match="No such file"):
        read_experiment(tmp_path / "none.toml")


def test_a_trial_is_named_by_what_decides_it() -> None:
    experiment = find_experiment("table")
    trials = experiment.make_trials(trials=2)
    again = {trial.id: trial for trial in experiment.make_trials(trials=2)}
    assert all(again[trial.id] == trial for trial in trials)
    assert len(again) == 2 * 24 * 2
    quick = experiment.make_trials(trials=2, quick=True)
    assert not {trial.id for trial in quick} & set(again)


def test_levels_go_over_engines_and_these_over_the_experiment() -> None:
    table = find_experiment("table")
    assert len(table.make_trials(["paper"])) == 6 * 4 * 10
    values = table.values("paper", table.cells()[-1])
    of_level, of_engine = ("local_view.false_positives", "pose_cells.n_x"), "local_view.front_end"
    assert [values[name] for name in of_level] == [0.1, 8]
    assert (values[of_engine], values["goal_memory.enabled"]) == ("scene numbers", False)
    Config().with_values(values)
    with pytest.raises(ValueError, match=r"arbitration has no engine 'paper'; it has: ours"):
        find_experiment("arbitration").values("paper", ())


def test_a_level_may_have_a_world_of_its_own() -> None:
    trials = find_experiment("additions").make_trials(trials=1)
    assert {trial.levels[0] for trial in trials} == {trial.world for trial in trials} > {"office", "campus"}
    assert all(trial.levels[0] == trial.world for trial in trials)


def test_quick_is_the_same_protocol_made_short() -> None:
    for experiment in catalogue():
        short, full = experiment.make_trials(quick=True), experiment.make_trials()
        assert len(short) < len(full) or len(full) <= 2
        assert [step.do for step in short[0].protocol] == [step.do for step in full[0].protocol]
        assert experiment.seconds(quick=True) <= 60.0 or experiment.seconds(quick=True) < 0.3 * experiment.seconds()
        assert all(trial.quick for trial in short)


def test_each_step_can_be_made_short() -> None:
    explore = Explore(do="explore", minutes=10)
    assert explore.shortened(0.1) == Explore(minutes=1.0)
    assert Repeat(times=4, steps=[explore]).shortened(0.5) == Repeat(times=2, steps=[Explore(minutes=5.0)])
    assert Tour(goals=11, visits=100).shortened(0.05) == Tour(goals=5, visits=5)
    assert Drive(path=[(0, 0)], laps=3).shortened(0.01).laps == 1
    assert Visit(places=["a"], timeout_s=100).shortened(0.5).timeout_s == 50
    assert Wait(seconds=10).shortened(0.2).about_s() == 2.0


def axis(name: str, levels: int) -> str:
    labels = ", ".join(f'{{label = "{n}"}}' for n in range(levels))
    return f'[[axes]]\nname = "{name}"\nlevels = [{labels}]\n'


def score(label: str, what: str) -> str:
    return f'[[scores]]\nlabel = "{label}"\n{what}'


IMPOSSIBLE = [
    ("x = " + "[" * 5000 + "]" * 5000, "nested too deeply"),
    ("".join(axis(f"a{n}", 2) for n in range(30)), "axes: .*8"),
    ("".join(axis(f"a{n}", 40) for n in range(8)), "6,553,600,000,000 cells; there may be 1,000"),
    ('[[axes]]\nname = "a"\nlevels = [{label = "0"}, {label = "0"}]', "axis 'a': two levels are labelled '0'"),
    (axis("a", 1) * 2, "axes: two are named 'a'"),
    (score("map error", 'score = "views"'), "scores: two are labelled 'map error'"),
    (score("x", 'score = "__class__"'), "score 'x': nothing is measured by the name '__class__'"),
    (score("x", 'score = "eror_m"'), r"nothing .* 'eror_m'; did you mean 'error_m'\?"),
    (score("x", 'score = "goal_N_s"'), "nothing is measured by the name 'goal_N_s'"),
    (score("x", 'score = "goal_2_s"'), "score 'x': 'goal_2_s' is of visits; the protocol has 0"),
    (score("x", 'rate = ["recovered", "kidnaps"]'), "score 'x': 'recovered' is of kidnaps; the protocol has 0"),
    (
        '[[protocol]]\ndo = "repeat"\ntimes = 10000\n'
        'steps = [{do = "repeat", times = 10000, steps = [{do = "wait", seconds = 1}]}]',
        r"a trial takes 1e\+08 simulated s; it may take 1e\+06",
    ),
    ("x = 1" + "0" * 5000, "not valid TOML"),
    ("# " + "x" * 300_000, "more than 200 kB"),
]


def test_what_no_run_can_do_is_refused_before_anything_is_made_of_it(tmp_path: Path, subtests: pytest.Subtests) -> None:
    """Each of these was called right, or ended in a traceback or without memory."""
    for also, message in IMPOSSIBLE:
        path = written(tmp_path, f"{LEAST}\n{also}\n")
        with subtests.test(msg=message), pytest.raises(ValueError, match=message):
            read_experiment(path).check()
    unknown = LEAST.replace("[engines.ours]", '[engines.ours]\nset = { "pose_cells.size" = 3 }')
    with pytest.raises(ValueError, match=r"unknown parameter 'pose_cells.size'"):
        read_experiment(written(tmp_path, unknown)).check()
    many = f"{LEAST}\n{axis('a', 1000)}".replace("world", "trials = 200\nworld")
    with pytest.raises(ValueError, match="mine: 200,000 trials in all cells; there may be 100,000"):
        read_experiment(written(tmp_path, many)).make_trials()


def test_each_measure_gives_the_readings_that_it_declares_and_no_two_the_same() -> None:
    """By these a file's scores are checked, and what is measured is told in words."""
    course = find_experiment("trial").make_trials(trials=1)[0].begin()
    declared = [name for kind in MEASURES for name in kind.readings]
    assert len(set(declared)) == len(declared)
    for kind in MEASURES:
        given = Measuring(course, [kind]).values()
        assert set(given) <= set(kind.readings), kind
        for name, value in given.items():
            assert reading_of(name).shown(value)


ASKED = """
import ast
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from app.code_version import code_version

began, plain, read = Barrier(4), ast.parse, []
ast.parse = lambda text: (read.append(text), plain(text))[1]

def ask(_):
    began.wait()
    return code_version()

with ThreadPoolExecutor(4) as pool:
    print(len(set(pool.map(ask, range(4)))), len(read) == len(set(read)) > 9)
"""


def test_the_version_of_the_program_is_made_once_however_many_ask() -> None:
    """At once, as at a start with a page already open. CPython up to 3.12: ast.parse raises SystemError while another
    thread is in it (its issue 106905)."""
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, timeout=300, check=True)
    assert done.stdout == "1 True\n"

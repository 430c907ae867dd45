"""Two brains beside one another as the page commands it: from the beginning, from now on, again, in the past, to the end."""

from __future__ import annotations

import pytest

from app.config import Config, Value
from app.config.presets import NAMES, PRESETS, pair_of, pairs_beside, without
from app.engine.engine import Engine
from app.protocol.trial import run_trial
from app.recordings.playing import Player
from app.session import LONGEST_NAME, Session
from ratslam_core.params.additions import ADDITIONS
from web import messages as m
from web.http.state import beside_fields

from .engines import an_engine, tell
from .made_recordings import recorded
from .sessions import OFFICE
from .trials_to_watch import short_trial

pytestmark = pytest.mark.slow


def run_for(engine: Engine, ticks: int) -> None:
    for _ in range(ticks):
        engine.tick()


def shown(engine: Engine) -> m.BesideView:
    view = engine.snapshot().beside
    assert view is not None
    return view


def digest(session: Session) -> str:
    assert session.companion is not None
    return session.companion.digest()


@pytest.mark.parametrize("pair", [pair.name for pair in pairs_beside(Config())])
def test_every_pair_begins_by_its_name_and_is_shown(pair: str) -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 20)
    assert tell(engine, type="compare_brains", pair=pair).startswith("two brains on the same senses: ")
    assert engine.run.session.tick_count == 0
    shown(engine)  # at once
    run_for(engine, 120)
    view = shown(engine)
    assert view.first.experiences == len(engine.run.session.brain.experience_map)
    assert view.first.name != view.second.name
    assert [difference.tick for difference in view.differences] == sorted(d.tick for d in view.differences)
    assert view.differences or pair == "rate"  # which has learnt nothing else by then
    assert view.error_odometry_m is not None


FIRSTS: list[dict[str, Value]] = [
    {},
    *({**values} for name, values in PRESETS.items() if name.startswith("paper-")),
    {"pose_cells.n_x": 8, "pose_cells.n_y": 8},
    {"pose_cells.n_x": 21, "pose_cells.n_y": 21},
    {"local_view.enabled": False, "local_view.learning_rate": 0.02},
]


@pytest.mark.parametrize("values", FIRSTS, ids=range(len(FIRSTS)))
def test_whatever_the_first_is_pairs_differ_from_it_and_additions_are_turned(values: dict[str, Value]) -> None:
    first = Config().with_values(values)
    pairs = pairs_beside(first)
    seconds = [first.with_values(pair.values) for pair in pairs]
    assert first not in seconds
    assert len(set(map(repr, seconds))) == len({pair.title for pair in pairs}) == len(pairs)
    assert {pair.name for pair in pairs} >= set(NAMES) - {"cells-64"}
    assert all(pair.first != pair.second for pair in pairs)
    for addition in ADDITIONS:  # each is a pair by its name
        pair = pair_of(addition.name, first)
        second = first.with_values(pair.values)
        assert second != first
        assert pair.second == f"{'with' if without(addition, first) else 'without'} {addition.name}"
        assert without(addition, second) != without(addition, first)
        assert set(pair.values) == set(addition.off)
        assert 0 < len(pair.second) <= LONGEST_NAME


def test_ours_has_every_addition_and_the_papers_lack_each_at_least_in_part() -> None:
    assert not set(NAMES) & {addition.name for addition in ADDITIONS}
    assert [addition.name for addition in ADDITIONS if without(addition, Config())] == []
    papers = [Config().with_values(values) for name, values in PRESETS.items() if name.startswith("paper-")]
    assert all(without(addition, paper) for addition in ADDITIONS for paper in papers)
    assert pair_of("exact solver", papers[-1]).second == "with exact solver"  # though it sweeps by experience, as ours


def test_an_addition_begins_by_its_name_and_the_page_is_told_which_are_off() -> None:
    engine = an_engine(OFFICE)
    assert engine.snapshot().additions_off == m.AdditionsOff()
    tell(engine, type="compare_brains", pair="exact solver")
    run_for(engine, 20)
    view = shown(engine)
    assert (view.first.name, view.second.name) == ("ours", "without exact solver")
    assert {(changed.name, changed.first, changed.second) for changed in view.changed} == {
        ("experience_map.exact_solver", True, False),
        ("experience_map.solve_every", 50, 0),
        ("experience_map.sweep", "by experience", "by link"),
    }
    tell(engine, type="compare_brains", pair="law of evidence", since="now")
    assert (shown(engine).second.name, shown(engine).since_s) == ("without law of evidence", 2.0)
    tell(engine, type="set_parameter", name="local_view.facing", value=False)
    tell(engine, type="set_parameter", name="experience_map.familiar_ground", value=False)
    off = ("heading from the shift", "familiar ground")
    assert engine.snapshot().additions_off == m.AdditionsOff(off, off)
    tell(engine, type="compare_brains", pair="familiar ground")
    assert (shown(engine).first.name, shown(engine).second.name) == ("as set", "with familiar ground")


def test_what_is_offered_begins_by_the_names_that_were_told_and_what_differs_is_told() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="use_preset", name="paper-2006")
    tell(engine, type="set_parameter", name="pose_cells.n_x", value=8)
    tell(engine, type="set_parameter", name="pose_cells.n_y", value=8)
    tell(engine, type="set_parameter", name="local_view.enabled", value=False)
    offered = engine.snapshot().pairs
    titles = {choice.name: choice.title for choice in offered if choice.since == "beginning"}
    assert (titles["papers"], titles["cells"], titles["vision"]) == ("Ours", "64 x 64 pose cells", "With vision")
    assert {choice.name for choice in offered if choice.since == "now"} == {"vision", "rate"}
    for name, second in (("papers", "ours"), ("cells", "64 x 64 cells"), ("vision", "with vision")):
        tell(engine, type="compare_brains", pair=name)
        assert shown(engine).second.name == second
        run_for(engine, 20)
        assert all(changed.first != changed.second for changed in shown(engine).changed)
        assert shown(engine).changed is shown(engine).changed
    assert shown(engine).changed == (m.Changed("local_view.enabled", False, True),)
    assert beside_fields(shown(engine))["changed"] == [{"name": "local_view.enabled", "first": False, "second": True}]


def test_ending_it_leaves_its_figures_on_the_timeline() -> None:
    engine = an_engine(OFFICE)
    tell(engine, type="compare_brains", pair="cells")
    run_for(engine, 100)
    words, number = tell(engine, type="end_comparison"), len(engine.run.session.brain.experience_map)
    begins = f"the comparison ends: after 10 s 64 x 64 cells: {number} experiences, 0 relocalisations, map error"
    assert words.startswith(begins)
    assert words.endswith("; different since tick 0")
    assert engine.snapshot().beside is None
    with pytest.raises(ValueError, match="no second brain"):
        tell(engine, type="end_comparison")


def test_from_now_on_and_again_from_the_beginning_after_a_restart() -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 50)
    tell(engine, type="compare_brains", pair="vision", since="now")
    assert shown(engine).since_s == 5.0
    run_for(engine, 30)
    assert {difference.kind for difference in shown(engine).differences} >= {"view"}
    tell(engine, type="reset", seed=4)
    view = shown(engine)
    assert (engine.run.session.tick_count, view.since_s, view.second.name) == (0, 0.0, "without vision")


def test_what_cannot_be_is_refused_and_the_run_goes_on(subtests: pytest.Subtests) -> None:
    engine = an_engine(OFFICE)
    run_for(engine, 5)
    refused: list[tuple[dict[str, object], str]] = [
        ({}, "either a pair or values"),
        ({"pair": "cells", "values": {"pose_cells.n_x": 8}}, "either a pair or values"),
        ({"pair": "cells-64"}, "the first brain is that already: nothing would differ; what would: papers, vision"),
        ({"pair": "nobody"}, "there is no pair 'nobody'; expected one of: papers, vision"),
        ({"pair": "exact"}, "no-map; or an addition: image and sonars, waiting time of new views, "),
        ({"pair": "exact solver", "since": "now"}, "experience_map.exact_solver cannot change while a brain runs"),
        ({"values": {"pose_cells.n_x": 64}}, "nothing would differ"),
        ({"values": {"pilot.seek": False}}, "pilot.seek cannot differ"),
        ({"pair": "cells", "since": "now"}, "pose_cells.n_x, pose_cells.n_y cannot change while a brain runs"),
    ]
    for fields, words in refused:
        with subtests.test(msg=str(fields)):
            with pytest.raises(ValueError, match=words):
                tell(engine, type="compare_brains", **fields)
            assert (engine.run.session.tick_count, engine.snapshot().beside) == (5, None)


def test_the_past_shows_both_as_they_were_and_a_branch_goes_on_with_both() -> None:
    engine, were = an_engine(OFFICE), dict[int, tuple[object, ...]]()

    def told(session: Session) -> tuple[object, ...]:
        view = shown(engine)
        return digest(session), view.pose_cells.path.tolist(), view.second, view.differences

    tell(engine, type="compare_brains", pair="cells")
    for tick in range(1, 231):
        engine.tick()
        if tick in (40, 160, 200):
            were[tick] = told(engine.run.session)
        if tick == 170:  # beyond a keyframe
            tell(engine, type="kidnap", x=5.0, y=1.0, heading_rad=0.0)
    for tick, then in were.items():
        tell(engine, type="seek", tick=tick)
        assert told(engine.shown.session) == then, tick
    tell(engine, type="seek", tick=160)
    tell(engine, type="go_on_from_here")
    run_for(engine, 5)
    assert engine.run.session.companion is not None


def test_a_trial_that_is_watched_is_the_same_beside_another_brain() -> None:
    trial = short_trial()
    engine = an_engine(OFFICE)
    engine.begin_trial(trial, "A title")
    run_for(engine, 7)
    tell(engine, type="compare_brains", pair="cells")
    assert (engine.run.trial is not None, engine.run.session.tick_count) == (True, 0)
    engine.running = True
    while engine.trial_plays:
        engine.tick()
    assert engine.run.trial is not None
    assert not engine.run.trial.altered
    assert engine.run.session.state_hash() == run_trial(trial)[0].state_hash


def test_two_settings_on_one_recording() -> None:
    engine = an_engine(OFFICE)
    engine.begin_recording(Player(recorded(60)))
    tell(engine, type="compare_brains", values={"local_view.enabled": False}, name="blind")
    engine.running = True
    while engine.running:
        engine.tick()
    view = shown(engine)
    assert (view.second.name, view.second.views, view.first.views > 5) == ("blind", 0, True)
    assert "view" in [difference.kind for difference in view.differences]

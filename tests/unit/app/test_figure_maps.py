"""Maps and series of figures show what the traces of the trials say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from app.experiments.figures import draw, wanted
from app.experiments.figures.map_panels import broken_path, plateau
from tests.unit.app.made_trials import RATES, SIZES, figure, loop_times, material


def drawn(of, show, **options):
    """The first panel of maps, and the trace that it shows."""
    made = draw(figure("maps", show=show, **options), of)
    return made.figure.axes[0], of.traces[wanted(made.spec, of)[0]]


def test_maps_ask_for_the_first_seed_of_each_cell_or_the_median_trial():
    of = material()
    ids = wanted(figure("maps", show="path", each="size"), of)
    chosen = [trial for trial in of.trials if trial.id in ids]
    assert {(t.engine, t.levels) for t in chosen} == {(e, ("0 %", s)) for e in ("paper", "ours") for s in SIZES}
    assert {trial.seed for trial in chosen} == {10}
    assert wanted(figure("curves", score="goals reached", along="N_vis", lines="size"), of) == []
    (first, second) = wanted(figure("series", channels=["views"], pick="median", score="map error"), of)
    for chosen, engine in ((first, "paper"), (second, "ours")):
        errors = sorted(t.scores["error_m"] for t in of.of(engine, {0: "0 %", 1: "8"}))
        assert next(t for t in of.trials if t.id == chosen).scores["error_m"] == errors[1]


def test_the_map_is_drawn_with_all_its_links_over_the_plan():
    panel, trace = drawn(material(traced=True), "experience map", each="size")
    links = np.ma.filled(np.ma.asarray(panel.lines[0].get_xydata()), np.nan).reshape(-1, 3, 2)
    np.testing.assert_array_equal(links[:, :2], trace.map.poses[trace.map.links, :2])
    assert np.isnan(links[:, 2]).all()
    walls = panel.collections[0].get_segments()
    np.testing.assert_array_equal(np.array(walls).reshape(-1, 4), trace.plan.walls)
    assert panel.patch.get_gid() == f"trial-{trace.trial.id}"


def test_the_way_to_a_goal_is_drawn_apart_from_the_rest_of_the_path():
    panel, trace = drawn(material(traced=True), "path", each="seed", most=1)
    way = next(line for line in panel.lines if line.get_label() == "truth, sent to a goal").get_xydata()
    sent = (trace.time_s >= 40) & (trace.time_s <= 59)  # two visits, one after the other
    np.testing.assert_array_equal(np.isfinite(way[:, 0]), sent)
    np.testing.assert_array_equal(way[sent], trace.truth[sent, :2])


def test_all_panels_show_the_same_stretch_and_odometry_is_cut_off_far_outside():
    of = material(traced=True)
    for trace in list(of.traces.values())[1:]:
        of.traces[trace.trial.id] = replace(trace, odometry_path=trace.odometry_path * 10)
    axes = draw(figure("maps", show="path", each="seed", most=2), of).figure.axes
    assert len({(panel.get_xlim(), panel.get_ylim()) for panel in axes}) == 1
    assert axes[0].get_xlim() == pytest.approx((-0.4, 10 + 3 + 0.4))
    assert axes[0].get_ylim() == pytest.approx((-0.4, 8 + 3 + 0.4))


def test_movements_are_drawn_as_the_trace_has_them():
    of = material(traced=True)
    panel, trace = drawn(of, "movements", each="seed", most=1)
    shown = trace.movements
    arcs = {e.get_label(): np.array(e.get_segments()) for e in panel.collections if isinstance(e, LineCollection)}
    np.testing.assert_array_equal(arcs["barred arc"], shown.paths[[0]])
    np.testing.assert_array_equal(arcs["free arc"], shown.paths[[1, 2]])  # a turn on the spot has no arc
    lines = {line.get_label(): line.get_xydata() for line in panel.lines}
    np.testing.assert_array_equal(lines["chosen arc"], shown.paths[1, :-1])
    np.testing.assert_array_equal(lines["route ahead"], shown.route)
    np.testing.assert_array_equal(lines["point it steers towards"], [shown.aim])
    for low, middle, high in zip(panel.viewLim.min, (5.0, 4.0), panel.viewLim.max, strict=True):
        assert (low + high) / 2 == pytest.approx(middle)
    of.traces = {key: replace(trace, movements=None) for key, trace in of.traces.items()}
    panel, _ = drawn(of, "movements")
    assert panel.get_xlabel() == "no choice between free and barred arcs"
    assert len(panel.collections[0].get_segments()) == 4  # the plan


def test_the_plateau_is_marked_opposite_the_goal():
    panel, _ = drawn(material(traced=True), "goal memory")
    (ring,) = [line.get_xydata() for line in panel.lines if line.get_label().startswith("plateau")]
    assert ring == pytest.approx(np.array([[3.0, 8.0]]), abs=1)


def test_a_plateau_is_a_watershed_and_not_any_cell_with_two_ways():
    times, lead = loop_times()
    assert np.argwhere(plateau(times, np.zeros_like(lead), 4.0))[:, 1].max() <= 5  # however many cells have two ways
    assert not plateau(times, np.full_like(lead, np.inf), 4.0).any()  # one way only
    assert not plateau(np.full_like(times, np.inf), lead, 4.0).any()
    across = np.roll(times, 7, axis=1), np.roll(lead, 7, axis=1)  # the faces are joined
    assert (plateau(*across, 4.0) == np.roll(plateau(times, lead, 4.0), 7, axis=1)).all()


def test_the_path_through_the_pose_cells_is_broken_at_faces_and_snaps():
    of = material(traced=True)
    trace = next(iter(of.traces.values()))
    path = broken_path(trace)
    gaps = int(np.isnan(path[:, 0]).sum())
    whole = path[~np.isnan(path[:, 0])]
    assert len(whole) == len(trace.time_s)
    parts = np.split(path, np.flatnonzero(np.isnan(path[:, 0])))
    steps = np.concatenate([np.diff(part[~np.isnan(part[:, 0])], axis=0) for part in parts])
    assert np.abs(steps).max() < 8
    assert gaps == 3 + 2  # it goes round three times, and snaps twice
    assert whole.min() >= -0.5
    assert whole.max() < 15.5


def test_series_show_the_time_round_the_kidnap():
    of = material(traced=True)
    axes = draw(figure("series", channels=["off", "x"], after="kidnapped", seconds=30), of).figure.axes
    assert axes[0].get_xlim() == pytest.approx((-5, 30))
    marked = [float(line.get_xdata()[0]) for line in axes[0].lines if len(line.get_xdata()) == 2]
    assert marked == pytest.approx([0.0, 13.0])
    assert [text.get_text() for text in axes[0].texts] == ["kidnapped", "recovered"]


def test_levels_of_an_axis_are_lines_of_one_panel():
    of = material(traced=True)
    axes = draw(figure("series", channels=["residual"], each="N_vis"), of).figure.axes
    assert [panel.get_title() for panel in axes] == ["the paper's rules", "our rules"]
    for panel in axes:
        assert [line.get_label() for line in panel.lines] == list(RATES)

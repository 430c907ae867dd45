"""What figures draw is what the trials say, read back from the figures themselves."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex

from app.experiments.figures import KINDS, draw
from app.experiments.figures.canvas import CYCLE, ENGINE_COLOUR, THEMED, png_of, style, svg_of
from app.experiments.figures.curves import positions
from app.experiments.figures.survival import until
from app.experiments.summary import value_of, wilson
from app.protocol.experiment import Axis, Level
from app.protocol.figure_options import OPTIONS, Shown
from tests.unit.app.made_trials import RATES, SIZES, experiment, figure, material

SHOWN = list(Shown.__args__)
SPECS = [
    figure("curves", score="goals reached", along="N_vis", lines="size"),
    figure("curves", score="map error", along="N_vis", spacing="linear", log=True),
    figure("dots", score="map error", by="size", at=["2 %"]),
    figure("dots", score="goals reached"),
    *(figure("maps", show=show, each="size") for show in SHOWN),
    figure("maps", show="path", each="seed", most=3),
    figure("series", channels=["packets", "off", "map error", "residual", "views", "experiences"]),
    figure("series", channels=["active experience", "x", "heading"], after="kidnapped", seconds=30, pick="median",
           score="map error"),
    figure("series", channels=["residual", "map error"], each="N_vis", log=True),
    figure("survival", score="after"),
    figure("survival", score="after a way of", lines="size", most=30),
]  # fmt: skip
NAMES = [f"{n}-{spec.kind}-{spec.options.get('show', '')}" for n, spec in enumerate(SPECS)]


def test_every_kind_that_a_file_may_name_is_drawn():
    assert set(KINDS) == set(OPTIONS)


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("spec", SPECS, ids=NAMES)
def test_a_figure_is_the_same_file_each_time(spec):
    first, again = draw(spec, material(traced=True)), draw(spec, material(traced=True))
    svg = svg_of(first.figure)
    assert svg == svg_of(again.figure)
    assert "<dc:date>" not in svg
    ET.fromstring(svg)


@pytest.mark.slow
def test_a_figure_may_be_written_again_and_leaves_the_settings_of_matplotlib_alone():
    before = dict(mpl.rcParams)
    first, again = draw(SPECS[0], material()).figure, draw(SPECS[0], material()).figure
    svg, png = svg_of(first), png_of(again)
    assert (png_of(first), svg_of(again)) == (png, svg)
    assert png.startswith(b"\x89PNG")
    assert dict(mpl.rcParams) == before
    with style():
        colours = {to_hex(each) for each in mpl.rcParams["axes.prop_cycle"].by_key()["color"]}
    assert colours | set(CYCLE) <= set(THEMED)


@pytest.mark.slow
def test_the_caption_says_where_the_numbers_are_from(subtests):
    of = material(traced=True)
    for spec, name in zip(SPECS, NAMES, strict=True):
        with subtests.test(msg=name):
            caption = draw(spec, of).caption
            assert caption.startswith("D 6, figure 9. ")
            assert re.search(r"Seeds? 1\d\b", caption)
            assert "version v1" in caption
            if spec.options.get("score") == "goals reached":
                assert "Original: 81 % at 0 %, 8 (D figure 9)" in caption
                assert "n = 4 in each cell" in caption


# ------------------------------------------------------------ curves


def drawn_lines(panel):
    return [line for line in panel.lines if line.get_linestyle() == "-" and len(line.get_xdata())]


def dots_of(panel):
    """Those that stand for a trial, by its name."""
    return {line.get_gid(): line for line in panel.lines if line.get_gid()}


def test_curves_go_through_the_summary():
    """And the paper's value is an open diamond at its level."""
    of = material()
    panels = draw(SPECS[0], of).figure.axes
    assert [panel.get_title() for panel in panels] == ["the paper's rules", "our rules"]
    for panel, engine in zip(panels, ("paper", "ours"), strict=True):
        bars = [each for each in panel.collections if each.get_segments()]
        for line, bar, size in zip(drawn_lines(panel), bars, SIZES, strict=True):
            cells = [of.cell(engine, {0: rate, 1: size}) for rate in RATES]
            estimates = [cell.values["goals reached"] for cell in cells]
            assert line.get_ydata() == pytest.approx([e.value for e in estimates])
            ends = [[segment[0][1], segment[1][1]] for segment in bar.get_segments()]
            np.testing.assert_allclose(ends, [[e.low, e.high] for e in estimates])
        (diamond,) = [line for line in panel.lines if line.get_marker() == "D" and len(line.get_xdata())]
        assert (list(diamond.get_ydata()), diamond.get_markerfacecolor()) == ([0.81], "none")
        assert round(float(diamond.get_xdata()[0])) == RATES.index("0 %")


def test_levels_stand_where_their_numbers_are():
    assert positions(["0 %", "2 %", "10 %"], "even") == [0, 1, 2]
    assert positions(["0 %", "2 %", "10 %"], "linear") == [0, 2, 10]
    assert positions(["1 Hz", "-2.5 Hz"], "log") == [1, -2.5]
    with pytest.raises(ValueError, match="no number in the level 'off'; expected spacing = 'even'"):
        positions(["1", "off"], "linear")


def test_levels_with_long_names_lie_one_below_the_other():
    of = experiment()
    named = {"0 %": "none at all, never", "2 %": "some", "10 %": "rather many of them"}
    axis = Axis(name="N_vis", levels=[Level(label=label) for label in named.values()])
    of = material(of.model_copy(update={"axes": [axis, of.axes[1]], "original": []}))
    panel = draw(SPECS[0], of).figure.axes[0]
    assert [label.get_text() for label in panel.get_yticklabels()] == list(named.values())
    assert panel.yaxis_inverted()
    assert panel.get_xlabel() == "goals reached"
    points = dots_of(panel)
    assert len(points) == 6
    for gid, line in points.items():
        assert list(line.get_xdata()) == [of.cells[int(gid.removeprefix("cell-"))].values["goals reached"].value]


def test_only_the_levels_asked_for_are_drawn():
    asked = figure("curves", score="map error", along="N_vis", lines="size", at=["2 %", "10 %", "16"])
    panel = draw(asked, material()).figure.axes[0]
    assert [label.get_text() for label in panel.get_xticklabels()] == ["2", "10"]
    assert panel.get_xlabel() == "N_vis (%)"  # the unit that all share stands beside the axis
    assert len(drawn_lines(panel)) == 1


# ------------------------------------------------------------ dots


def test_without_an_axis_every_combination_has_its_place():
    of = material()
    panel = draw(figure("dots", score="map error"), of).figure.axes[0]
    assert len(dots_of(panel)) == len(of.trials)
    assert len(panel.get_xticklabels()) == len(RATES) * len(SIZES)


def test_every_trial_is_a_dot_with_its_id_beside_the_interval_of_the_summary():
    of = material()
    panel = draw(SPECS[2], of).figure.axes[0]
    dots = {name: dot for name, dot in dots_of(panel).items() if name.startswith("trial-")}
    shown = [trial for trial in of.trials if trial.levels[0] == "2 %"]
    assert set(dots) == {f"trial-{trial.id}" for trial in shown}
    svg = svg_of(panel.figure)
    for trial in shown:
        dot = dots[f"trial-{trial.id}"]
        assert list(dot.get_ydata()) == [value_of(of.score("map error"), trial)]
        assert dot.get_markerfacecolor() == ENGINE_COLOUR[trial.engine]
        assert f'id="trial-{trial.id}"' in svg
    ends = [tuple(segment[:, 1]) for each in panel.collections for segment in each.get_segments()]
    cells = [of.cell(engine, {0: "2 %", 1: size}).values["map error"] for size in SIZES for engine in ("paper", "ours")]
    np.testing.assert_allclose(ends, [(cell.low, cell.high) for cell in cells])


# ------------------------------------------------------------ survival


def test_trials_in_which_it_never_came_count_as_well():
    of = material()
    panel = draw(SPECS[-2], of).figure.axes[0]
    steps = [line for line in panel.lines if line.get_gid() is None]
    dots = dots_of(panel)
    for line, engine in zip(steps, ("paper", "ours"), strict=True):
        trials = of.of(engine, {0: "0 %", 1: "8"})
        known = until(trials, of.score("after"))
        assert len(known) == sum(trial.scores["recovered"] for trial in trials)
        assert float(line.get_ydata()[-1]) == pytest.approx(len(known) / 4)
        assert line.get_xdata()[1 : len(known) + 1] == pytest.approx([seconds for seconds, _ in known])
        assert line.get_label().endswith(f"{len(known)} of 4")
        for number, (seconds, trial) in enumerate(known, start=1):
            assert dots.pop(f"trial-{trial.id}").get_xydata().tolist() == [[seconds, number / 4]]
    assert not dots
    band = panel.collections[0].get_paths()[0].vertices
    last = wilson(len(until(of.of("paper", {0: "0 %", 1: "8"}), of.score("after"))), 4)
    assert band[:, 1].max() == pytest.approx(last.high)


# ------------------------------------------------------------ what cannot be drawn


def test_a_trial_without_a_score_is_left_out():
    of = material()
    for trial in of.trials[:3]:
        del trial.scores["error_m"]
    left_out = sum(trial.levels[0] == "2 %" for trial in of.trials[:3])
    assert len(dots_of(draw(SPECS[2], of).figure.axes[0])) == 16 - left_out


@pytest.mark.slow
def test_a_single_trial_has_no_interval_and_is_drawn_nevertheless():
    of = material(experiment(trials=1))
    for spec in (SPECS[0], SPECS[2], SPECS[-1]):
        assert not re.search(r"\bnan\b", svg_of(draw(spec, of).figure), re.IGNORECASE)


def test_levels_that_were_not_run_are_left_out():
    of = material()
    of.trials = [trial for trial in of.trials if trial.levels[0] != "0 %" and trial.engine == "ours"]
    of.__post_init__()
    (panel,) = draw(SPECS[0], of).figure.axes
    assert [label.get_text() for label in panel.get_xticklabels()] == ["2", "10"]

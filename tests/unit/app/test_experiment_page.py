"""The page of an experiment holds everything and loads nothing."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from app.experiments import report
from app.experiments.figures import draw
from app.experiments.figures.canvas import svg_of
from app.experiments.page.inline_svg import inlined
from app.experiments.report import write_index, write_report_page
from app.experiments.sentences import found
from tests.unit.app.made_trials import experiment, figure, material, trace, trials

COMMAND = "ratslam experiment made --trials 4 && echo '<done>'"


class _Reader(HTMLParser):
    """Every element with its attributes, and the text."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.text, self._script = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text.append(data)

    def having(self, name):
        return [attributes[name] for _, attributes in self.elements if name in attributes]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("page")


@pytest.fixture(scope="module")
def written(out):
    """The report, the trials, and which of them were asked to be run again."""
    made = experiment(
        figures=[
            figure("curves", score="goals reached", along="N_vis", lines="size"),
            figure("dots", score="map error", by="size", at=["2 %"]),
            figure("maps", show="map grid", each="size"),
        ]
    )
    stored = trials(made)
    stored.append(replace(stored[0], id="f" * 16, seed=99, scores={}, error="ValueError: no <room>"))
    known, asked = {t.id: trace(t, made) for t in stored}, []

    def traces(wanted):
        asked.append([each.id for each in wanted])
        return [known[each.id] for each in wanted]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "trials_by_id", lambda *_, **__: {name: each.trial for name, each in known.items()})
        return write_report_page(made, stored, out, traces, command=COMMAND), stored, asked


def test_the_page_figures_and_index_are_there(written, out):
    made, _, asked = written
    index = write_index([made], out, "ratslam experiment all")
    names = sorted(path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file())
    kinds = ["1-curves", "2-dots", "3-maps"]
    figures = sorted(f"figures/made-{kind}.{ending}" for kind in kinds for ending in ("png", "svg"))
    assert names == [*figures, "index.html", "made.html"]
    assert [path.relative_to(out).as_posix() for path in sorted(made.figures)] == figures
    assert "made.html" in _Reader(index.read_text()).having("href")
    assert len(asked) == 1
    assert len(asked[0]) == len(set(asked[0])) == 4


def test_the_page_loads_nothing(written, out):
    made, *_ = written
    for path in (made.page, write_index([made], out, "x")):
        text = path.read_text()
        page = _Reader(text)
        assert "default-src 'none'" in text
        assert not page.having("src")
        links = [*page.having("href"), *page.having("xlink:href")]
        assert all(link.startswith(("#", "data:image/png")) or link == "made.html" for link in links)
        assert not [tag for tag, _ in page.elements if tag in ("link", "iframe", "img", "object", "embed", "base")]
        addresses = set(re.findall(r"https?://[^\s\"'<)]+", text))
        assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
        assert "@import" not in text
        assert all(each.startswith("url(#") for each in re.findall(r"url\([^)]*\)", text))


def test_ids_are_unique_and_references_are_met(written):
    page = _Reader(written[0].page.read_text())
    ids = page.having("id")
    assert len(ids) == len(set(ids))
    text = written[0].page.read_text()
    asked = {link[1:] for link in page.having("xlink:href") if link.startswith("#")} | set(
        re.findall(r"url\(#([^)]+)\)", text)
    )
    assert asked <= set(ids)


def test_what_people_write_is_escaped(written):
    made, *_ = written
    text = made.page.read_text()
    page = _Reader(text)
    assert "<up>" not in text
    assert "<b>this" not in text
    assert "<room>" not in text
    assert "<done>" not in text
    shown = " ".join(page.text)
    for words in ("Made <up> & never run", "Does <b>this</b> work?", 'It "does".', "no <room>", COMMAND):
        assert words in shown


def test_every_trial_is_listed_with_its_command(written):
    made, stored, _ = written
    text = made.page.read_text()
    page = _Reader(text)
    told = json.loads(re.search(r'<script type="application/json" id="told">(.*?)</script>', text, re.DOTALL)[1])
    rows = [
        attributes["data-trial"] for tag, attributes in page.elements if tag == "button" and "data-trial" in attributes
    ]
    good = [trial.id for trial in stored if not trial.error]
    assert sorted(rows) == sorted(told["trials"]) == sorted(good)
    for trial in stored[:-1]:
        facts = told["trials"][trial.id]
        assert facts["command"] == f"ratslam experiment open {trial.id}"
        assert facts["levels"] == f"N_vis {trial.levels[0]}, size {trial.levels[1]}"
        assert facts["moment"] == "kitchen: reached, at 61.5 s"
        assert ["map error", f"{trial.scores['error_m']:.3g} m"] in facts["scores"]
    assert sorted(each for cell in told["cells"] for each in cell["trials"]) == sorted(good)
    assert stored[-1].id in text


def test_every_dot_can_be_reached_with_the_keyboard_and_tells_its_command(written):
    made, stored, _ = written
    page = _Reader(made.page.read_text())
    dots = [a for tag, a in page.elements if tag == "g" and "data-trial" in a]
    assert {dot["data-trial"] for dot in dots} >= {t.id for t in stored if t.levels[0] == "2 %" and not t.error}
    for dot in dots:
        assert dot["tabindex"] == "0"
        assert dot["role"] == "button"
        assert dot["aria-label"].startswith(f"ratslam experiment open {dot['data-trial']}\n")
    assert len([a for tag, a in page.elements if tag == "g" and "data-cell" in a]) == 12


def test_colours_of_a_figure_become_those_of_the_page():
    drawn = draw(figure("curves", score="goals reached", along="N_vis", lines="size"), material())
    svg = inlined(svg_of(drawn.figure), "f1", {}, "A <figure>")
    assert "#0072b2" not in svg
    assert "fill: var(--paper)" in svg
    assert "var(--blue)" in svg
    assert 'aria-label="A &lt;figure&gt;"' in svg
    assert svg.startswith("<svg ")


def test_sentences_say_the_numbers_of_the_summary():
    of = material()
    says = found(of.experiment, of.cells)
    assert [each.partition(":")[0] for each in says[:2]] == ["By the paper's rules", "By our rules"]
    paper, ours = (of.cell(engine, {0: "0 %", 1: "8"}).values["goals reached"] for engine in ("paper", "ours"))
    assert says[2].startswith("The paper has goals reached 81 % at 0 %, 8; here it is ")
    assert f"{paper.value:.0%}".replace("%", " %") in says[2]
    assert f"{ours.value:.0%}".replace("%", " %") in says[2]


def test_an_experiment_without_trials_has_a_page_that_says_so(tmp_path):
    made = write_report_page(
        experiment(figures=[figure("survival", score="after")]), [], tmp_path, lambda _: [], command="x"
    )
    assert "Nothing: no trial has been run." in made.page.read_text()
    assert made.figures == []


def test_a_trial_of_another_version_is_not_run_again_unseen(tmp_path):
    made = experiment(figures=[figure("maps", show="path")])
    with pytest.raises(ValueError, match="trial 0000000000000000 of made is of another version"):
        write_report_page(made, trials(made), tmp_path, lambda _: [], command="x")

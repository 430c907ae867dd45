"""The page of an experiment holds everything and loads nothing."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from app.experiments.figures import draw
from app.experiments.figures.canvas import svg_of
from app.experiments.page import inlined
from app.experiments.report import write_index, write_report_page
from app.experiments.summary import found
from tests.unit.app.made_trials import experiment, figure, material, trace, trials

COMMAND = "ratslam experiment made --trials 4 && echo '<done>'"


class Page(HTMLParser):
    """Every element of a file with its attributes, and the text."""

    def __init__(self, path):
        super().__init__()
        self.source, self.elements, self.text = path.read_text(), [], ""
        self.feed(self.source)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.text += f"{data} "

    def having(self, name, tag=None):
        return [about[name] for each, about in self.elements if name in about and tag in (None, each)]


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
        asked.append(wanted)
        return [known[each] for each in wanted]

    return write_report_page(made, stored, out, traces, command=COMMAND), stored, asked


@pytest.fixture(scope="module")
def page(written):
    return Page(written[0].page)


def test_the_page_figures_and_index_are_there(written, out):
    made, _, asked = written
    index = write_index([made], out, "ratslam experiment all")
    names = sorted(path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file())
    kinds = ["1-curves", "2-dots", "3-maps"]
    figures = sorted(f"figures/made-{kind}.{ending}" for kind in kinds for ending in ("png", "svg"))
    assert names == [*figures, "index.html", "made.html"]
    assert [path.relative_to(out).as_posix() for path in sorted(made.figures)] == figures
    assert "made.html" in Page(index).having("href")
    (ids,) = asked
    assert len(ids) == len(set(ids)) == 4


def test_the_page_loads_nothing_and_its_references_are_met(written, page, out):
    for each in (page, Page(write_index([written[0]], out, "x"))):
        assert "default-src 'none'" in each.source
        assert not each.having("src")
        links = [*each.having("href"), *each.having("xlink:href")]
        assert all(link.startswith(("#", "data:image/png")) or link == "made.html" for link in links)
        assert not {tag for tag, _ in each.elements} & {"link", "iframe", "img", "object", "embed", "base"}
        addresses = set(re.findall(r"https?://[^\s\"'<)]+", each.source))
        assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
        assert "@import" not in each.source
        assert all(url.startswith("url(#") for url in re.findall(r"url\([^)]*\)", each.source))
    ids = page.having("id")
    assert len(ids) == len(set(ids))
    asked = {link[1:] for link in page.having("xlink:href") if link.startswith("#")}
    assert asked | set(re.findall(r"url\(#([^)]+)\)", page.source)) <= set(ids)


def test_what_people_write_is_escaped(page):
    assert not re.findall("<up>|<b>this|<room>|<done>", page.source)
    for words in ("Made <up> & never run", "Does <b>this</b> work?", 'It "does".', "no <room>", COMMAND):
        assert words in page.text


def test_every_trial_is_listed_with_its_command(written, page):
    _, stored, _ = written
    script = re.search(r'<script type="application/json" id="data">(.*?)</script>', page.source, re.DOTALL)
    told, good = json.loads(script[1]), sorted(trial.id for trial in stored if not trial.error)
    assert sorted(page.having("data-trial", "button")) == sorted(told["trials"]) == good
    for trial in stored[:-1]:
        facts = told["trials"][trial.id]
        assert facts["command"] == f"ratslam experiment open {trial.id}"
        assert facts["levels"] == f"N_vis {trial.levels[0]}, size {trial.levels[1]}"
        assert facts["moment"] == "kitchen: reached, at 61.5 s"
        assert ["map error", f"{trial.scores['error_m']:.3g} m"] in facts["scores"]
    assert sorted(each for cell in told["cells"] for each in cell["trials"]) == good
    assert stored[-1].id in page.source


def test_every_dot_can_be_reached_with_the_keyboard_and_tells_its_command(written, page):
    dots = [about for tag, about in page.elements if tag == "g" and "data-trial" in about]
    shown = {trial.id for trial in written[1] if trial.levels[0] == "2 %" and not trial.error}
    assert {dot["data-trial"] for dot in dots} >= shown
    for dot in dots:
        assert (dot["tabindex"], dot["role"]) == ("0", "button")
        assert dot["aria-label"].startswith(f"ratslam experiment open {dot['data-trial']}\n")
    assert len(page.having("data-cell", "g")) == 12


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


def test_without_trials_the_page_says_so(tmp_path):
    made = experiment(figures=[figure("survival", score="after")])
    report = write_report_page(made, [], tmp_path, lambda _: [], command="x")
    assert "Nothing: no trial has been run." in report.page.read_text()
    assert report.figures == []

"""The real program in a real browser: what a person does on the page has its effect in the office."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from sim2d import load_world
from tests import patience
from tests.e2e.browser import box_of, eye_of, on_screen, open_page, show, told, until
from tests.e2e.program import Program
from web.viewer.fits.map_fit import MapFit, refit
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.plates.map_plate import ORIGIN as MAP_ORIGIN
from web.viewer.plates.office_plate import ORIGIN as OFFICE_ORIGIN


@pytest.fixture(scope="module")
def explored(program):
    """Seven minutes of exploring without a page. Where the settled map lies in the office is kept as pairs of places."""
    program.command("pause")
    program.command("reset", seed=5)
    program.command("step", ticks=1000)
    pairs = []  # collected only now, since closing loops bends the map
    for _ in range(120):
        program.command("step", ticks=25)
        state = program.state()
        pairs.append([[state["estimate"]["x"], state["estimate"]["y"]], [state["robot"]["x"], state["robot"]["y"]]])
    program.pairs = np.array(pairs)
    return program


def in_office(pairs: np.ndarray, place: np.ndarray) -> np.ndarray:
    """A place of the map in the office, by the rigid motion that fits the pairs best."""
    on_map, true = pairs[:, 0], pairs[:, 1]
    a, b = on_map - on_map.mean(0), true - true.mean(0)
    angle = math.atan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return turn @ (place - on_map.mean(0)) + true.mean(0)


def node_on_stage(program, node: np.ndarray, nodes: np.ndarray) -> tuple[float, float, float]:
    fit = refit(MapFit(), nodes, program.state(full=True)["map"]["turn_rad"])
    x, y = fit.to_plate(node)[0]
    return MAP_ORIGIN[0] + x, MAP_ORIGIN[1] + y, MAP_ORIGIN[2] + NODE_Z


def robot_on_stage(state: dict, x: float, y: float) -> tuple[float, float, float]:
    fit = OfficeFit(load_world(state["world"]).bounds)
    plate_x, plate_y = fit.to_plate(np.array([[x, y]]))[0]
    return OFFICE_ORIGIN[0] + plate_x, OFFICE_ORIGIN[1] + plate_y, OFFICE_ORIGIN[2] + 0.15


def test_it_is_alive(program, browser):
    with open_page(browser, program.url) as page:
        program.command("resume")
        before = program.state()["time_s"]
        until(page, "() => document.getElementById('clock').textContent >= '0:02'")
        assert program.state()["time_s"] > before
        colours = page.frame_locator("#stage").locator("canvas").first.screenshot()
        assert len(colours) > 20_000  # an empty canvas compresses to far less
        assert page.locator("#status span").inner_text() in ("exploring", "lost: 2 packets")
        page.keyboard.press("Space")
        program.wait(lambda state: not state["running"])
        page.wait_for_selector("#play[aria-label=Play]")
        tick = program.state()["tick"]
        page.keyboard.press(".")
        program.wait(lambda state: state["tick"] == tick + 1)


def test_a_click_on_a_far_node_brings_the_robot_there(explored, browser):
    with open_page(browser, explored.url) as page:
        page.keyboard.press("t")  # another palette draws the map anew; where it lies depends on its nodes alone
        page.get_by_role("tab", name="Truth").click()
        page.get_by_label("Closed loops on the map").uncheck()  # a click on a ring would play the loop again
        show(page, "map")
        state = explored.state(full=True)
        nodes = np.array(state["map"]["xy"])
        here = np.array([state["estimate"]["x"], state["estimate"]["y"]])
        far = nodes[np.argsort(np.linalg.norm(nodes - here, axis=1))[int(len(nodes) * 0.9)]]
        page.mouse.click(*on_screen(page, "map", node_on_stage(explored, far, nodes)))
        goal = explored.wait(lambda state: state["goal"] is not None)["goal"]
        assert math.dist((goal["x"], goal["y"]), far) < 0.4
        page.wait_for_selector("#goal:not([hidden])")
        explored.command("set_speed", factor=16)
        explored.command("resume")
        arrived = explored.wait(lambda state: state["goal"] is None or state["goal"]["state"] == "arrived")
        assert arrived["goal"] is not None
        there = in_office(explored.pairs, np.array([arrived["goal"]["x"], arrived["goal"]["y"]]))
        assert math.dist((arrived["robot"]["x"], arrived["robot"]["y"]), there) < 1.5
        until(page, "() => document.querySelector('#goal .what').textContent === 'arrived'")
        page.click("#cancel")
        explored.wait(lambda state: state["goal"] is None)
    explored.command("set_speed", factor=1)


@pytest.mark.parametrize("where", ["page", "stage"])
def test_a_held_key_drives_and_letting_go_stops(program, browser, where):
    program.command("set_speed", factor=1)
    program.command("resume")
    with open_page(browser, program.url, stage=where == "stage") as page:
        if where == "stage":
            page.mouse.click(780, 200)  # beside the plates: the focus is in viser's frame now, and no goal is set
        page.keyboard.down("ArrowLeft")
        before = program.wait(lambda state: state["mode"] == "manual")
        heading = before["robot"]["heading_rad"]
        turned(program, heading)
        page.keyboard.up("ArrowLeft")
        page.wait_for_selector("#status[data-tone=hand], #status[data-tone=lost]")
        assert_still(program)


def assert_still(program) -> None:
    """After a while, ticks go by and the robot stays where it is. The program is asked, since drawing may delay the page."""

    def still() -> bool:
        first = program.state()
        second = program.wait(lambda state: state["tick"] >= first["tick"] + 4)
        here, there = ([state["robot"][name] for name in ("x", "y", "heading_rad")] for state in (first, second))
        return here == pytest.approx(there, abs=0.01)

    patience.until(still, "the robot stands")


def turned(program, heading_rad: float) -> None:
    program.wait(lambda state: abs(math.remainder(state["robot"]["heading_rad"] - heading_rad, math.tau)) > 0.2)


LEAVE = """async (end) => {
    document.hasFocus = () => false;
    window.dispatchEvent(new Event(end));
    await new Promise((noticed) => setTimeout(noticed));
}"""  # the page notices in its next task, which software rendering may hold up


@pytest.mark.parametrize("end", ["blur", "pagehide", "gone"])
def test_the_robot_stops_when_the_page_cannot_hold_it(program, browser, end):
    program.command("resume")
    with open_page(browser, program.url, stage=False) as page:
        page.keyboard.down("d")
        turned(program, program.wait(lambda state: state["mode"] == "manual")["robot"]["heading_rad"])
        if end == "gone":
            page.goto("about:blank")
        else:
            page.evaluate(LEAVE, end)
        assert_still(program)


@pytest.mark.long
def test_the_pad_drives_while_it_is_held(program, browser):
    program.command("resume")
    with open_page(browser, program.url, 390, 844, stage=False) as page:
        pad = box_of(page.locator("[data-drive=left]"))
        assert min(pad["width"], pad["height"]) >= 52
        before = program.state()["robot"]["heading_rad"]
        page.mouse.move(pad["x"] + 26, pad["y"] + 26)
        page.mouse.down()
        turned(program, before)
        page.mouse.up()
        assert_still(program)


def test_dragging_the_robot_kidnaps_it(explored, browser):
    explored.command("pause")
    with open_page(browser, explored.url) as page:
        show(page, "office")
        state = explored.state()
        robot = state["robot"]
        world = load_world(state["world"])
        low_x, low_y, high_x, high_y = world.bounds
        corners = [(low_x + 0.8, low_y + 0.8), (high_x - 0.8, high_y - 0.8)]
        target = max(corners, key=lambda corner: math.dist(corner, (robot["x"], robot["y"])))
        page.mouse.move(*on_screen(page, "office", robot_on_stage(state, robot["x"], robot["y"])))
        page.wait_for_timeout(500)
        page.mouse.down()
        places = (robot["x"], robot["y"]), target
        start, end = (on_screen(page, "office", robot_on_stage(state, *place)) for place in places)
        for share in np.linspace(0.1, 1, 10):
            page.mouse.move(start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))
            page.wait_for_timeout(80)
        page.wait_for_timeout(500)
        page.mouse.up()
        moved = explored.wait(lambda now: math.dist((now["robot"]["x"], now["robot"]["y"]), target) < 0.6)
        assert moved["estimate"] == state["estimate"]  # nobody told it
        until(page, "() => document.getElementById('events').textContent.includes('kidnap')")


MANY_STEPS = (
    """() => { for (let k = 0; k < 60; k++) window.dispatchEvent(new KeyboardEvent("keydown", {key: "."})); }"""
)


def test_a_refusal_is_a_sentence_on_the_page(program, browser):
    with open_page(browser, program.url, stage=False) as page:
        page.evaluate(MANY_STEPS)
        told(page, "At most 10 commands a second")


SEEN = """() => JSON.stringify(["clock", "seed", "status", "events"].map((id) => document.getElementById(id).textContent))"""
THEMES = """() => [document.documentElement.dataset.theme,
    document.getElementById("stage").contentDocument.documentElement.dataset.mantineColorScheme].join(", the stage ")"""
DARK, LIGHT = "dark, the stage dark", "light, the stage light"


@pytest.mark.long
def test_two_tabs_agree_each_in_its_own_theme_and_a_reload_comes_back_to_the_same(program, browser):
    program.command("pause")
    with open_page(browser, program.url) as one, open_page(browser, program.url, 900, 700, light=True) as two:
        shown = f"themes => ({THEMES})() === themes"
        until(one, shown, argument=DARK)
        until(two, shown, argument=LIGHT)
        alike = lambda: one.evaluate(SEEN) == two.evaluate(SEEN)  # noqa: E731
        patience.until(alike)
        one.keyboard.press("t")
        until(one, shown, argument=LIGHT)
        two.keyboard.press("t")
        until(two, shown, argument=DARK)
        assert one.evaluate(THEMES) == LIGHT
        two.keyboard.press("Space")
        one.wait_for_selector("#play[aria-label=Pause]")
        one.keyboard.press("Space")
        two.wait_for_selector("#play[aria-label=Play]")
        patience.until(alike)
        one.reload()
        patience.until(alike)
        until(one, shown, argument=LIGHT)  # remembered where it was chosen, against what the system prefers
        assert two.evaluate(THEMES) == DARK


@pytest.mark.long
def test_another_theme_leaves_a_turned_camera_where_it_is(program, browser):
    program.command("pause")
    with open_page(browser, program.url) as page:
        show(page, "all")
        home = eye_of(page)
        page.mouse.move(700, 200)
        page.mouse.down()
        page.mouse.move(740, 190, steps=4)
        page.mouse.up()

        def at_rest() -> bool:
            before = eye_of(page)
            page.wait_for_timeout(500)
            return math.dist(before, home) > 1 and np.array_equal(before, eye_of(page))

        patience.until(at_rest)
        turned, told_anew = eye_of(page), []
        page.on("websocket", lambda socket: socket.on("framesent", lambda frame: told_anew.append(frame)))
        page.keyboard.press("t")
        until(page, f"themes => ({THEMES})() === themes", argument=LIGHT)
        patience.until(lambda: page.wait_for_timeout(50) or told_anew)
        page.wait_for_timeout(1000)
        patience.until(lambda: page.wait_for_timeout(50) or math.dist(eye_of(page), turned) < 0.1)


HIDDEN = """(on) => {
    Object.defineProperty(document, "hidden", { get: () => on, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
}"""  # as beneath another window


def plates_of(page) -> np.ndarray:
    """What the stage shows, once it has been the same twice."""
    shots = [b"", b""]

    def at_rest() -> bool:
        shots[:] = shots[1], page.frame_locator("#stage").locator("canvas").first.screenshot()
        page.wait_for_timeout(1000)
        return shots[0] == shots[1]

    patience.until(at_rest, "the plates rest")
    return cv2.imdecode(np.frombuffer(shots[1], np.uint8), cv2.IMREAD_GRAYSCALE).astype(float)


@pytest.mark.long
def test_a_page_that_is_open_while_the_program_is_restarted_shows_the_new_one(browser):
    """Another seed, another world, on the same port, while nobody looks at the page: the plates are those of a page that is
    opened now."""
    first = Program("--port", "0", "--seed", "1", "--paused")
    first.command("step", ticks=200)
    with open_page(browser, first.url, gone=True) as page:
        show(page, "office")
        old = plates_of(page)
        page.evaluate("() => { document.getElementById('stage').contentWindow.old = true; }")
        page.evaluate(HIDDEN, True)
        assert first.stop() == 0
        told(page, "Connection lost")
        second = Program("--port", str(first.port), "--seed", "2", "--world", "loop", "--paused")
        try:
            told(page, "Connected again")
            page.evaluate(HIDDEN, False)
            until(page, "() => document.getElementById('seed').textContent === '2'")
            until(page, "() => !document.getElementById('stage').contentWindow.old")
            page.wait_for_selector("#stage.awake")
            with open_page(browser, second.url) as fresh:
                show(fresh, "office")
                wanted = plates_of(fresh)
            now = plates_of(page)
            assert np.abs(now - wanted).mean() < 0.2 * np.abs(old - wanted).mean()
            page.click("#play")
            second.wait(lambda state: state["running"])
        finally:
            assert second.stop() == 0


def test_a_port_in_use_is_a_sentence(program):
    with pytest.raises(RuntimeError) as refused:
        Program("--port", str(program.port))
    assert f"Port {program.port}" in str(refused.value)
    assert "--port" in str(refused.value)
    assert "Traceback" not in str(refused.value)

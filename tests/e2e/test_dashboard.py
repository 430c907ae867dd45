"""The real program in a real browser: what a person does on the page has its effect in the office, and the plates show it.

One page serves all of these tests, in turn: its stage is most of what a page costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from sim2d import load_world
from tests import patience
from tests.e2e.browser import box_of, eye_of, on_screen, open_page, show, told, turn_theme, until
from tests.e2e.program import Program
from web.messages import Packet
from web.viewer.camera_views import camera_for
from web.viewer.fits import CellFit, MapFit, OfficeFit, refit
from web.viewer.marks import names
from web.viewer.plates import office_plate
from web.viewer.plates.map_plate import NODE_Z
from web.viewer.plates.map_plate import ORIGIN as MAP_ORIGIN
from web.viewer.plates.pose_cell_plate import ORIGIN as CELLS_ORIGIN
from web.viewer.pointer import DOOR_Z

Place = tuple[float, float, float]


@pytest.fixture(scope="module")
def opened(program: Program, browser: Browser) -> Iterator[Page]:
    with open_page(browser, program.url) as page:
        yield page


@pytest.fixture
def page(opened: Page, program: Program) -> Page:
    """The page as it is at first, dark and without a toast; its robot has just begun, and waits."""
    program.command("pause")
    program.command("set_speed", factor=1)
    program.command("reset", world="office", seed=5)
    until(opened, "() => document.getElementById('clock').textContent === '0:00'")
    if opened.get_attribute("html", "data-theme") != "dark":
        turn_theme(opened)
    opened.get_by_role("tab", name="Senses").click()
    opened.evaluate(QUIET)
    return opened


QUIET = """() => {
    document.activeElement.blur();
    document.querySelectorAll(".toast").forEach((toast) => toast.remove());
    toasted.clear(); }"""


def node_on_stage(program: Program, node: np.ndarray, nodes: np.ndarray) -> Place:
    fit = refit(MapFit(), nodes, program.state(full=True)["map"]["turn_rad"])
    x, y = fit.to_plate(node)[0]
    return MAP_ORIGIN[0] + x, MAP_ORIGIN[1] + y, MAP_ORIGIN[2] + NODE_Z


THEMES = """() => [document.documentElement.dataset.theme,
    document.getElementById("stage").contentDocument.documentElement.dataset.mantineColorScheme]"""


def show_map_anew(page: Page) -> None:
    """In another palette, in which it is drawn anew: where it lies depends on its nodes alone, not on how it has grown."""
    show(page, "all")
    page.keyboard.press("t")
    until(page, f"() => ({THEMES})().join() === 'light,light'")
    show(page, "map")


def on_office(world: str, x: float, y: float, z: float = 0.15) -> Place:
    """A place of a world on its plate."""
    plate_x, plate_y = OfficeFit(load_world(world).bounds).to_plate(np.array([[x, y]]))[0]
    return office_plate.ORIGIN[0] + plate_x, office_plate.ORIGIN[1] + plate_y, office_plate.ORIGIN[2] + z


def robot_on_stage(state: dict, x: float, y: float) -> Place:
    return on_office(state["world"], x, y)


def place_of(pose: dict[str, float]) -> tuple[float, float]:
    return pose["x"], pose["y"]


def nearest(nodes: np.ndarray, place: tuple[float, float]) -> np.ndarray:
    return nodes[np.argmin(np.hypot(*(nodes - place).T))]


def drag(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    """As slowly as a hand, over viser's canvas, which looks at a pointer only now and then."""
    page.mouse.move(*start)
    page.wait_for_timeout(500)
    page.mouse.down()
    for x, y in np.linspace(start, end, 11)[1:].tolist():
        page.mouse.move(x, y)
        page.wait_for_timeout(80)
    page.wait_for_timeout(500)
    page.mouse.up()


COLOURS = """(canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set();
    for (let k = 0; k < data.length; k += 4) seen.add(data.slice(k, k + 3).join());
    return seen.size; }"""
MANY_STEPS = """() => {
    for (let k = 0; k < 60; k++) window.dispatchEvent(new KeyboardEvent("keydown", {key: "."})); }"""


def test_it_is_alive(program: Program, page: Page) -> None:
    """It moves, plates and panel are drawn, keys have their effect, and a refusal is a sentence on the page."""
    program.command("resume")
    before = program.state()["time_s"]
    camera = "document.querySelector('#panel-senses canvas')"
    until(page, f"() => ({COLOURS})({camera}) > 20")
    first = page.evaluate(f"() => {camera}.toDataURL()")
    until(page, "() => document.getElementById('clock').textContent >= '0:02'")
    assert program.state()["time_s"] > before
    assert len(page.frame_locator("#stage").locator("canvas").first.screenshot()) > 20_000  # an empty one: far less
    until(page, f"(first) => {camera}.toDataURL() !== first", argument=first)
    assert page.get_by_role("img", name="pose cells seen from above").evaluate(COLOURS) > 3  # a packet
    page.keyboard.press("Space")
    program.wait(lambda state: not state["running"])
    page.wait_for_selector("#play[aria-label=Play]")
    tick = program.state()["tick"]
    page.keyboard.press(".")
    program.wait(lambda state: state["tick"] == tick + 1)
    page.evaluate(MANY_STEPS)
    told(page, "At most 10 commands a second")


def test_a_click_on_a_far_node_brings_the_robot_there(program: Program, page: Page) -> None:
    way = []
    for _ in range(10):
        program.command("step", ticks=100)
        way.append(program.state())
    state = program.state(full=True)
    was = max(way, key=lambda then: math.dist(place_of(then["robot"]), place_of(state["robot"])))
    assert math.dist(place_of(was["robot"]), place_of(state["robot"])) > 3
    page.get_by_role("tab", name="Truth").click()
    page.get_by_label("Closed loops on the map").uncheck()  # a click on a ring would play the loop again
    show_map_anew(page)
    nodes = np.array(state["map"]["xy"])
    far = nearest(nodes, place_of(was["estimate"]))
    page.mouse.click(*on_screen(page, "map", node_on_stage(program, far, nodes)))
    goal = program.wait(lambda state: state["goal"] is not None)["goal"]
    assert math.dist(place_of(goal), far) < 0.4
    page.wait_for_selector("#goal:not([hidden])")
    program.command("set_speed", factor=16)
    program.command("resume")
    arrived = program.wait(lambda state: state["goal"] is None or state["goal"]["state"] == "arrived")
    assert arrived["goal"] is not None
    assert math.dist(place_of(arrived["robot"]), place_of(was["robot"])) < 1.5
    until(page, "() => document.querySelector('#goal .what').textContent === 'arrived'")
    page.click("#cancel")
    program.wait(lambda state: state["goal"] is None)


def test_a_click_with_shift_on_the_map_and_a_click_into_the_pose_cells_inspect(program: Program, page: Page) -> None:
    program.command("step", ticks=450)
    show_map_anew(page)
    nodes = np.array(program.state(full=True)["map"]["xy"])
    wanted = nodes[len(nodes) // 2]
    page.keyboard.down("Shift")
    page.mouse.click(*on_screen(page, "map", node_on_stage(program, wanted, nodes)))
    page.keyboard.up("Shift")
    expect(page.get_by_role("tab", name="Inspect", exact=True)).to_have_attribute("aria-selected", "true")
    panel = page.get_by_role("tabpanel")
    expect(panel).to_contain_text("Links to other experiences")
    number = page.get_by_label("experience #")
    assert np.hypot(*(nodes[int(number.input_value())] - wanted)) < 0.3
    assert program.state()["goal"] is None  # the click was no goal

    show(page, "pose")
    state = program.state()["pose_cells"]
    packet = Packet(**state["packets"][0])
    apart = replace(packet, x=(packet.x + state["shape"][0] / 4) % state["shape"][0])
    at = CellFit(tuple(state["shape"])).packet(apart) + CELLS_ORIGIN
    page.mouse.click(*on_screen(page, "pose", tuple(at.tolist())))
    expect(panel).to_contain_text("pose cells at")
    expect(panel).to_contain_text("Views linked here, by strength")
    page.get_by_role("button", name="Inject", exact=True).click()
    until(page, "() => document.getElementById('events').textContent.includes('packet')")
    program.command("step")
    assert len(program.state()["pose_cells"]["packets"]) == 2


def test_dragging_the_robot_kidnaps_it(program: Program, page: Page) -> None:
    program.command("step", ticks=100)
    show(page, "office")
    state = program.state()
    here = place_of(state["robot"])
    low_x, low_y, high_x, high_y = load_world(state["world"]).bounds
    corners = [(low_x + 0.8, low_y + 0.8), (high_x - 0.8, high_y - 0.8)]
    target = max(corners, key=lambda corner: math.dist(corner, here))
    drag(page, *(on_screen(page, "office", robot_on_stage(state, *place)) for place in (here, target)))
    moved = program.wait(lambda now: math.dist(place_of(now["robot"]), target) < 0.6)
    assert moved["estimate"] == state["estimate"]  # nobody told it
    until(page, "() => document.getElementById('events').textContent.includes('kidnap')")


def test_a_key_that_is_held_while_the_stage_has_the_focus_drives_and_letting_go_stops(
    program: Program, page: Page
) -> None:
    program.command("resume")
    page.mouse.click(780, 200)  # beside the plates: the focus is in viser's frame now, and no goal is set
    page.keyboard.down("ArrowLeft")
    before = program.wait(lambda state: state["mode"] == "manual")["robot"]["heading_rad"]
    turned = lambda state: math.remainder(state["robot"]["heading_rad"] - before, math.tau)  # noqa: E731
    program.wait(lambda state: turned(state) > 0.2)
    page.keyboard.up("ArrowLeft")
    page.wait_for_selector("#status[data-tone=hand], #status[data-tone=lost]")

    def still() -> bool:
        """While ticks go by. The program is asked, since drawing may delay the page."""
        first = program.state()
        second = program.wait(lambda state: state["tick"] >= first["tick"] + 4)
        return list(first["robot"].values()) == pytest.approx(list(second["robot"].values()), abs=0.01)

    patience.until(still, "the robot stands")


def test_the_camera_goes_with_the_robot_until_a_view_is_asked_for(program: Program, page: Page) -> None:
    follow = page.locator("#follow")
    follow.click()
    expect(follow).to_have_attribute("aria-pressed", "true")

    def above_the_robot() -> bool:  # it looks from the front, so only across
        page.wait_for_timeout(50)
        return abs(eye_of(page)[0] - on_office("office", *place_of(program.state()["robot"]))[0]) < 0.3

    patience.until(above_the_robot)
    program.command("kidnap", x=8.6, y=1.6, heading_rad=0.0)
    program.command("step", ticks=1)
    patience.until(above_the_robot)
    show(page, "all")
    expect(follow).to_have_attribute("aria-pressed", "false")


def test_the_candidate_movements_are_drawn_around_the_robot_while_they_are_switched_on(
    program: Program, page: Page
) -> None:
    program.command("step", ticks=40)  # it follows the wall, and 6 of 47 movements are blocked
    show(page, "office")
    x, y = on_screen(page, "office", on_office("office", *place_of(program.state()["robot"]), z=0.0))
    page.get_by_role("tab", name="Memory").click()
    switch = page.get_by_label("Candidate movements")

    def around_it() -> np.ndarray:
        clip = {"x": round(x) - 90, "y": round(y) - 90, "width": 180, "height": 180}
        return cv2.imdecode(np.frombuffer(page.screenshot(clip=clip), np.uint8), cv2.IMREAD_COLOR).astype(int)

    seen = [around_it()]

    def differs() -> int:
        return int((np.abs(around_it() - seen[-1]).max(2) > 60).sum())

    def stands_still() -> bool:
        seen.append(around_it())
        return differs() == 0

    patience.until(stands_still, "the stage stands still")
    switch.check()
    patience.until(lambda: differs() > 300, "the movements are drawn")
    switch.uncheck()
    patience.until(lambda: differs() < 30, "they are gone")


PRESSED = """() => document.activeElement.dispatchEvent(
    new KeyboardEvent("keydown", { key: "c", code: "KeyC", bubbles: true }))"""


def test_a_key_right_after_a_dialog_has_its_meaning(page: Page) -> None:
    """Until the next frame the focus is still where it was in the closed dialog."""
    page.keyboard.press("/")
    expect(page.locator("#places-typed")).to_be_focused()
    page.evaluate(PRESSED)  # a letter of what is looked for
    lessons = page.locator("#lessons-dialog")
    expect(lessons).to_be_hidden()
    page.evaluate(f"() => {{ document.getElementById('places-dialog').close(); ({PRESSED})(); }}")
    expect(lessons).to_be_visible()
    page.keyboard.press("Escape")
    expect(lessons).to_be_hidden()


ALIVE = (
    "office.doors",
    "office.script",
    "office.people",
)  # without, nobody stands in the door and nothing else moves it


def test_a_click_on_a_door_opens_and_shuts_it(program: Program, page: Page) -> None:
    for name in ALIVE:
        program.command("set_parameter", name=name, value=False)
    program.command("reset", world="living")
    program.command("resume")
    program.command("set_door", name="laboratory door", open=False)
    opening = lambda state: state["living"]["doors"]["laboratory door"]  # noqa: E731
    program.wait(lambda state: opening(state) == 0.0)
    show(page, "office")
    leaf = next(door for door in load_world("living").doors if door.name == "laboratory door")
    height = DOOR_Z * OfficeFit(load_world("living").bounds).relief
    page.mouse.click(*on_screen(page, "office", on_office("living", leaf.x + 0.5 * leaf.width, leaf.y, height)))
    state = program.wait(lambda state: opening(state) == 1.0)
    assert state["living"]["doors"]["meeting room door"] == 1.0  # no other door has moved
    page.get_by_role("tab", name="Office").click()
    page.get_by_role("tabpanel").get_by_label("laboratory door", exact=True).click()
    program.wait(lambda state: opening(state) == 0.0)
    program.command("pause")
    for name in ALIVE:
        program.command("set_parameter", name=name, value=True)


@pytest.mark.long
def test_the_name_of_a_place_is_a_goal_once_the_map_knows_it(program: Program, page: Page) -> None:
    program.command("step", ticks=1000)  # it has been in the library by then, and not at the printer
    places = {place.name: (place.x, place.y) for place in load_world("office").places}
    show(page, "office")
    for name in ("printer", "library"):
        page.mouse.click(*on_screen(page, "office", on_office("office", *places[name], names.Z)))
        if name == "printer":
            program.wait(lambda state: state["until"] is not None and state["until"]["state"] == "met")
            program.command("step", ticks=1)
    program.wait(lambda state: state["goal"] is not None)


@pytest.mark.long
def test_what_the_stage_refuses_is_told_to_whoever_did_it(program: Program, browser: Browser, page: Page) -> None:
    robot, wall = program.state()["robot"], load_world("office").walls[0]
    with open_page(browser, program.url, 900, 700, stage=False) as other:
        show(page, "office")
        places = place_of(robot), (wall.x1, wall.y1)
        drag(page, *(on_screen(page, "office", on_office("office", *place)) for place in places))
        told(page, "The robot stays where it is")
        assert program.state()["robot"] == robot
        expect(page.locator(".toast", has_text="The robot stays where it is")).to_have_count(0)  # a click would hit it
        show(page, "map")
        page.mouse.click(*on_screen(page, "map", (MAP_ORIGIN[0], MAP_ORIGIN[1] - 4.4, MAP_ORIGIN[2] + NODE_Z)))
        told(page, "No goal set: that is beside the map")
        assert other.locator("#alerts .toast").count() == 0


@pytest.mark.long
def test_the_stage_shows_both_brains_and_then_one_again(program: Program, page: Page) -> None:
    program.command("compare_brains", pair="papers")
    program.command("step", ticks=100)
    page.click("[data-view=all]")

    def stands(two: bool) -> bool:
        box = box_of(page.frame_locator("#stage").locator("canvas").first)
        return bool(abs(eye_of(page) - camera_for("all", box["width"] / box["height"], two=two).position).max() < 0.05)

    patience.until(lambda: stands(two=True), "both brains are in view")
    page.get_by_role("button", name="End the comparison").click()
    patience.until(lambda: stands(two=False), "one brain is in view")


@pytest.mark.long
def test_another_theme_is_of_one_page_and_leaves_a_turned_camera_where_it_is(
    program: Program, browser: Browser, page: Page
) -> None:
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
    with open_page(browser, program.url, 900, 700) as other:
        page.keyboard.press("t")
        until(page, f"() => ({THEMES})().join() === 'light,light'")
        assert other.evaluate(THEMES) == ["dark", "dark"]
    patience.until(lambda: page.wait_for_timeout(50) or told_anew)
    page.wait_for_timeout(1000)
    patience.until(lambda: page.wait_for_timeout(50) or math.dist(eye_of(page), turned) < 0.1)


HIDDEN = """(on) => {
    Object.defineProperty(document, "hidden", { get: () => on, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
}"""  # as beneath another window


def plates_of(page: Page) -> np.ndarray:
    """What the stage shows, once it has been the same twice."""
    shots = [b"", b""]

    def at_rest() -> bool:
        shots[:] = shots[1], page.frame_locator("#stage").locator("canvas").first.screenshot()
        page.wait_for_timeout(1000)
        return shots[0] == shots[1]

    patience.until(at_rest, "the plates rest")
    return cv2.imdecode(np.frombuffer(shots[1], np.uint8), cv2.IMREAD_GRAYSCALE).astype(float)


@pytest.mark.long
def test_a_page_that_is_open_while_the_program_is_restarted_shows_the_new_one(browser: Browser) -> None:
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


@pytest.mark.long
def test_a_port_in_use_is_a_sentence(program: Program) -> None:
    with pytest.raises(RuntimeError) as refused:
        Program("--port", str(program.port))
    assert f"Port {program.port}" in str(refused.value)
    assert "--port" in str(refused.value)
    assert "Traceback" not in str(refused.value)

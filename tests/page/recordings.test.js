// A recording on the page: what it lacks is not there, its end is told, the past and branches are as in the office.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fresh } from "./page.js";
import { byPython, command, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

const FRAMES = 60;
/** What the camera of a simulated robot sees, as a film. */
const FILM = `
import cv2, os
from app.session import Session
from sim2d import load_world
session = Session(load_world("office"), 1)
height, width, _ = session.frame.image.shape
writer = cv2.VideoWriter("walk.avi", cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (2 * width, 2 * height))
for _ in range(${FRAMES}):
    session.tick()
    picture = cv2.resize(session.frame.image, (2 * width, 2 * height), interpolation=cv2.INTER_NEAREST)
    writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
writer.release()
print(os.path.abspath("walk.avi"), end="")
`;
/** @type {Uint8Array | undefined} */
let film;

/** The film has been played to its end. @param {(page: Page) => Promise<unknown>} use */
const played = (use) =>
  fresh(
    async (page) => {
      film ??= readFileSync(byPython(FILM));
      page.choosesFiles("#open-files", ["walk.avi", film]);
      await page.told("walk.avi plays.");
      await command("set_speed", { factor: 0 });
      await page.says("#status", "the recording has ended");
      await use(page);
    },
    { expects: / 422 / },
  );

/** @param {Page} page */
const tabs = (page) =>
  page
    .all("[role=tab]")
    .filter((tab) => !tab.hidden)
    .map((tab) => tab.textContent);

test("it plays to its end, and what it lacks is not there", () =>
  played(async (page) => {
    assert.equal(page.find("#world").selectedOptions[0].text, "walk.avi");
    assert.equal(page.document.body.dataset.source, "recording"); // styles hide what would be of no use
    assert.equal(page.text("[data-view=office]"), "True path");
    assert.deepEqual(tabs(page), ["Senses", "Memory", "Inspect", "Tick", "Tune"]);
    page.press("e");
    await page.told("its robot goes where it went");
    page.press(" ");
    await page.told("restart it");
    assert.match(page.text("#restart-same"), /^\s*Play from the beginning with seed/);
    await page.fill("#world", "loop");
    await until("the office is back", async () => (await state()).world === "loop" && tabs(page).includes("Truth"));
  }));

test("a wrong one changes nothing", () =>
  fresh(
    async (page) => {
      page.choosesFiles("#open-files", ["broken.mcap", "no recording"]);
      await page.says("#open-wrong", "The robot goes on as before.");
      assert.equal((await state()).world, "office");
    },
    { expects: / 422 / },
  ));

test("the past is gone to, and a branch goes on from there", () =>
  played(async (page) => {
    const before = await state();
    assert.equal(before.tick, FRAMES - 1);
    const at = (/** @type {number} */ tick) => until(`tick ${tick}`, async () => (await state()).tick === tick);
    const x = (/** @type {number} */ time_s) => /** @type {[number, number]} */ ([6 + (1188 * time_s) / 60, 20]);
    page.drag("#timeline", [x(5.5), x(3)]);
    await until("it shows the past", () => page.shown("#past"));
    await until("it has come there", async () => Math.abs((await state()).time_s - 3) < 0.2);
    await command("seek", { tick: 20 });
    await until("the page has it", () => page.find("#timeline").getAttribute("aria-valuetext").startsWith("0:02.0 "));
    page.press("b");
    await at(19);
    page.press(",");
    await page.says(await page.tab("Tick"), "The recording tells of");
    await at(20);
    page.press("n");
    await until("it is now", () => !page.shown("#past"));
    assert.deepEqual((await state()).robot, before.robot);
    await command("seek", { tick: 20 });
    await page.click("#go-on");
    await page.says("#branches [aria-pressed=true]", /^2$/);
    await command("set_parameter", { name: "pose_cells.inhibit", value: 0.003 });
    page.press(" ");
    await page.says("#status", "the recording has ended");
    assert.equal((await state()).tick, FRAMES - 1);
    await page.push("Branches side by side");
    await page.says("#compare-words", "first difference at tick 21");
    await command("set_parameter", { name: "pose_cells.inhibit", value: 0.0003 });
  }));

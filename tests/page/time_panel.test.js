// The editor's script and daylight: adding, changing, deleting, refusing, undoing, and the effects.

import assert from "node:assert/strict";
import { test } from "node:test";
import { path } from "../unit/static/made.js";
import { fresh } from "./page.js";
import { command, state, told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

const DOOR = { name: "lab", hinge: [8, 1], angle_deg: 0, width: 1 };
const LAMP = { name: "desk lamp", x: 5, y: 5 };

/** An office with a door and a lamp at 0:00, and the panel of times open. @param {(page: Page) => Promise<void>} use */
const opened = (use) =>
  fresh(async (page) => {
    const add = (/** @type {string} */ list, /** @type {object} */ item) => ({ do: "add", list, item });
    await command("edit_world", { steps: [add("doors", DOOR), add("lamps", LAMP)] });
    await page.click("#edit");
    await until("the plan is drawn", () => page.find("#plan .outer"));
    page.press("c");
    await until("it is open, and has the keys", () => page.document.activeElement?.id === "time");
    await use(page);
  });

/** @param {Page} page @param {string} words */
const says = (page, words) => page.says("#plan-status", words);

/** @param {Page} page @param {number} k @param {string} part */
const inRow = (page, k, part) => page.all("#script-lines li[data-number]")[k].querySelector(part);

/** @param {Page} page @param {string} when @param {string} what @param {string} [which] */
async function addLine(page, when, what, which) {
  await page.fill("#script-add .when", when);
  await page.choose("#script-add .what", what);
  if (which !== undefined) await page.fill(`#script-add ${what === "Daylight" ? ".level" : ".which"}`, which);
  await page.click("#script-add button");
}

/** The world's script, by time, is this: time, action, name or level. @param {[number, string, unknown][]} lines */
async function linesAre(...lines) {
  const said = async () => {
    /** @type {any[]} */
    const script = (await told("world")).world.script ?? [];
    const sorted = script.toSorted((a, b) => a.at_s - b.at_s);
    return JSON.stringify(sorted.map((line) => [line.at_s, line.do, line.do === "daylight" ? line.level : line.name]));
  };
  const wanted = JSON.stringify(lines);
  await until(`the script is ${wanted}`, async () => (await said()) === wanted);
}

const SHUTS = /** @type {[number, string, unknown]} */ ([5, "close_door", "lab"]);
const DIMS = /** @type {[number, string, unknown]} */ ([2, "daylight", 0.3]);
const GOES_OUT = /** @type {[number, string, unknown]} */ ([1, "lamp_off", "desk lamp"]);

test("lines are added, changed and deleted, and happen", () =>
  opened(async (page) => {
    assert.ok(page.shown("#script-none"));
    await addLine(page, "0:05", "Door shuts", "lab");
    await says(page, "Added: at 0:05: door shuts lab.");
    await addLine(page, "2", "Daylight", "0.3");
    await addLine(page, "1:00:00.5", "People go");
    await linesAre(DIMS, SHUTS, [3600.5, "people_off", ""]);
    await until("three rows", () => page.all("#script-lines li[data-number]").length === 3);
    assert.deepEqual(
      [0, 1, 2].map((k) => inRow(page, k, ".when").value),
      ["0:02", "0:05", "1:00:00.5"],
    );

    await page.fill(inRow(page, 2, ".what"), "lamp_off");
    await linesAre(DIMS, SHUTS, [3600.5, "lamp_off", "desk lamp"]);
    await page.fill(inRow(page, 2, ".when"), "1"); // it goes to the top, and the keys stay with it
    await linesAre(GOES_OUT, DIMS, SHUTS);
    const held = () => /** @type {HTMLElement} */ (page.document.activeElement);
    await until("the keys are there", () => held().closest("li")?.dataset.at === "1");
    assert.equal(held().className, "when");

    await command("step", { ticks: 30 });
    await page.says(".now", "now 0:03");
    assert.deepEqual(
      page.all("#script-lines li").map((row) => row.className),
      ["past", "past", "now", ""],
    );
    const living = async () => (await state()).living;
    const { lamps, doors, daylight } = await living();
    assert.deepEqual([lamps["desk lamp"], doors.lab], [false, 1]);
    assert.ok(Math.abs(daylight - 0.3) < 1e-9);
    await command("step", { ticks: 40 });
    assert.equal((await living()).doors.lab, 0);
    await page.says("#clock", "0:07");
    await addLine(page, "0:04", "Door opens", "lab");
    await says(page, "That is past; it happens after a restart.");
    await command("step", { ticks: 20 });
    assert.equal((await living()).doors.lab, 0);

    await page.click(inRow(page, 0, ".remove"));
    await says(page, "Line deleted");
    await page.click("#edit-undo");
    await linesAre(GOES_OUT, DIMS, [4, "open_door", "lab"], SHUTS);
    await page.click("#edit-undo");
    await linesAre(GOES_OUT, DIMS, SHUTS);
    await page.click("#edit-redo");
    await linesAre(GOES_OUT, DIMS, [4, "open_door", "lab"], SHUTS);
  }));

test("what is no time or level is refused with the reason", () =>
  opened(async (page) => {
    const before = (await told("world")).world;
    for (const [when, what, which, reason] of [
      ["soon", "Door shuts", "lab", "“soon” is no time; write seconds (90), or minutes and seconds (1:30)."],
      ["-4", "Door shuts", "lab", "“-4” is no time"],
      ["1:2:3:4", "People come", undefined, "“1:2:3:4” is no time"],
      ["2000000", "People come", undefined, "at_s: got 2000000; input should be less than or equal to 1000000"],
      ["5", "Daylight", "", "is no level; write a number from 0"],
      ["5", "Daylight", "7", "level: got 7; input should be less than or equal to 3"],
    ]) {
      await addLine(page, String(when), String(what), which);
      await says(page, String(reason));
      assert.equal(page.find("#plan-status").className, "bad");
    }
    const off = page.all("#script-add .what option").filter((option) => option.disabled);
    assert.deepEqual(
      off.map((option) => option.textContent),
      ["Box appears (no boxes)", "Box goes (no boxes)"],
    );
    await addLine(page, "9", "Lamp off", "desk lamp");
    await says(page, "Added: at 0:09");
    await linesAre([9, "lamp_off", "desk lamp"]);
    await page.fill(inRow(page, 0, ".when"), "x");
    await says(page, "“x” is no time");
    assert.equal(inRow(page, 0, ".when").getAttribute("aria-invalid"), "true");
    await page.fill(inRow(page, 0, ".when"), "0:08");
    await linesAre([8, "lamp_off", "desk lamp"]);
    page.press("Escape");
    assert.ok(!page.shown("#time"));
    assert.equal(page.document.activeElement?.id, "edit-time");
    assert.deepEqual({ ...(await told("world")).world, script: null }, { ...before, script: null });
  }));

test("the daylight is written by its points", () =>
  opened(async (page) => {
    const is = (/** @type {string | null} */ points, /** @type {number} */ repeat_s) => {
      const course = JSON.stringify(points && { points: path(points), repeat_s });
      const now = async () => JSON.stringify((await told("world")).world.daylight ?? null);
      return until(`the daylight is ${course}`, async () => (await now()) === course);
    };
    const add = async (/** @type {string} */ when, /** @type {string} */ level) => {
      await page.fill("#daylight-add .when", when);
      await page.fill("#daylight-add .level", level);
      return page.click("#daylight-add button");
    };
    assert.ok(!page.shown("#daylight-again"));
    for (const [when, level] of Object.entries({ "0:10": "0.5", "0:00": "1", "0:20": "0.25" })) {
      await add(when, level);
      await says(page, `Added: daylight ${level}`);
    }
    await is("0 1, 10 0.5, 20 0.25", 0);
    assert.equal(page.all("#daylight-curve .point").length, 3);
    await add("10", "0.4");
    await says(page, "There is a point at 0:10 already; change that one.");
    await add("11", "4");
    await says(page, "has level 4; must be from 0 to 3");
    await command("step", { ticks: 50 });
    await page.says("#daylight-now", /^0\.75$/);

    await page.fill(page.all("#daylight-points li")[1].querySelector(".level"), "0.1");
    await is("0 1, 10 0.1, 20 0.25", 0);
    await page.fill("#daylight-repeat", "0:15");
    await says(page, "15 s must be 0 or at least the last point's 20 s");
    await page.fill("#daylight-repeat", "0:30");
    await is("0 1, 10 0.1, 20 0.25", 30);
    await page.says("#daylight-curve", "0:30, then again");
    for (let left = 2; left >= 0; left--) {
      await page.click("#daylight-points .remove");
      await until(`${left} points are left`, () => page.all("#daylight-points li").length === left);
    }
    await is(null, 0);
    await command("step", { ticks: 1 });
    await page.says("#daylight-now", /^1\.00$/);
    await page.click("#edit-undo");
    await is("20 0.25", 30);
  }));

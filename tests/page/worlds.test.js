// A person's own worlds: begun empty or with a file, saved, renamed, deleted and brought back.

import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { beforeEach, test } from "node:test";
import { path } from "../unit/static/made.js";
import { fresh } from "./page.js";
import { edit, world } from "./plan.js";
import { command, own, post, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

const file = (/** @type {string} */ name) => join(own, `${name}.json`);
const listed = (/** @type {Page} */ page) => page.all("#world option").map((option) => option.value);

const REFUSED = { expects: / 422 / };

beforeEach(async () => {
  rmSync(own, { recursive: true, force: true });
  mkdirSync(own);
});

/** @param {Page} page @param {string} item */
async function menu(page, item) {
  await page.click("#edit-menu summary");
  await page.click(item);
}

test("an empty world is begun, drawn in, and saved", () =>
  fresh(async (page) => {
    await page.click("#restart summary");
    await page.click("#new-world");
    await page.fill("#new-name", "office");
    await page.click("#new-form .go");
    await page.says("#new-wrong", "choose another name");
    await page.fill("#new-name", "gym");
    await page.fill("#new-title", "The gym");
    await page.fill("#new-width", "12");
    await page.fill("#new-depth", "6.5");
    await page.click("#new-form .go");
    await page.says("#edit-name", /^The gym$/); // in the editor, to draw
    assert.ok(!page.shown("#new-dialog") && page.shown("#edit-unsaved"));
    const { world: name, tick } = await state();
    assert.deepEqual([name, tick], ["gym", 0]);
    const { walls, starts, lamps } = await world();
    assert.deepEqual(
      walls.map((/** @type {Wall} */ wall) => wall.to),
      path("12 0, 12 6.5, 0 6.5, 0 0"),
    );
    assert.deepEqual([starts.length, lamps.length], [1, 1]);
    assert.ok(!existsSync(file("gym")));

    await page.click("#edit-save");
    await page.click("#save-form .go");
    await until("it is saved", () => !page.shown("#edit-unsaved"));
    assert.equal(JSON.parse(readFileSync(file("gym"), "utf-8")).walls.length, 4);
    await menu(page, "#edit-new");
    await until("it asks", () => page.find("#new-dialog").open);
    assert.equal(page.find("#new-name").value, "my-world");
    assert.ok(!page.shown("#new-unsaved"));
    await page.click("#new-close");
  }, REFUSED));

test("saving under another name can rename", () =>
  fresh(async (page) => {
    await command("edit_world", { steps: [{ do: "add", list: "places", item: { name: "p", x: 0.9, y: 2 } }] });
    await edit(page);
    await page.click("#edit-save");
    assert.ok(!page.shown("#save-rename-row")); // it comes with the program
    await page.fill("#save-name", "second");
    await page.fill("#save-title", "Second");
    await page.click("#save-form .go");
    await page.says("#edit-name", /^Second$/);
    await page.click("#edit-save");
    assert.ok(!page.shown("#save-rename-row"));
    await page.fill("#save-name", "third");
    await page.click("#save-rename");
    await page.says("#save-rename-row", "“Second”, saved as second, goes");
    await page.click("#save-form .go");
    await until("it is renamed", () => listed(page).includes("third") && !listed(page).includes("second"));
    assert.deepEqual(
      ["second", "third"].map((name) => existsSync(file(name))),
      [false, true],
    );
    await page.click("#edit-undo"); // an older office, under its present name
    await until(
      "it is undone",
      async () => !((await world()).places ?? []).some((/** @type {any} */ place) => place.name === "p"),
    );
    assert.equal((await state()).world, "third");
  }));

test("a saved world is opened, deleted and brought back", async () => {
  await command("reset", { world: "office" });
  const office = await world();
  for (const [name, title] of Object.entries({ lab: "My laboratory", school: "A school" }))
    writeFileSync(file(name), JSON.stringify({ ...office, name, title }));
  await fresh(async (page) => {
    await edit(page);
    await menu(page, "#edit-open");
    await page.push("Open My laboratory");
    await until("it is open", async () => (await state()).world === "lab");
    await page.says("#edit-name", /^My laboratory$/);
    await menu(page, "#edit-open");
    await page.says("#own-list", "open now");
    await page.push("Delete My laboratory");
    assert.ok(page.shown("#delete-open"));
    await page.click("#delete-dialog [value=keep]");
    assert.ok(existsSync(file("lab")));
    await page.push("Delete My laboratory");
    await page.click("#delete-dialog [value=delete]");
    await until("it can be brought back", () => page.button("Bring My laboratory back"));
    assert.ok(!existsSync(file("lab")));
    await until("it goes on, but is in no file", () => page.shown("#edit-unsaved"));
    assert.equal((await state()).world, "lab");
    await page.push("Bring My laboratory back");
    await until("it is in a file again", () => !page.shown("#edit-unsaved"));
    assert.ok(existsSync(file("lab")));
    await page.push("Delete My laboratory");
    await page.click("#delete-dialog [value=delete]");
    await until("it is in no file", () => page.shown("#edit-unsaved"));
    await page.click("#open-close");
    await page.fill("#world", "loop");
    await page.click("#leave-dialog [value=leave]");
    await until("it is left", async () => (await state()).world === "loop");
    await until("it is listed no more", () => !listed(page).includes("lab"));
    assert.ok(listed(page).includes("school"));
  });
});

/** A grey picture of the kind that robots write. @param {number} width @param {number} height @param {(x: number, y: number) => number} level */
function pgm(width, height, level) {
  const pixels = Array.from({ length: width * height }, (_, k) => level(k % width, Math.floor(k / width)));
  return Buffer.concat([Buffer.from(`P5\n${width} ${height}\n255\n`), Buffer.from(pixels)]);
}
const within = (/** @type {number} */ x, /** @type {number} */ low, /** @type {number} */ high) => x >= low && x < high;
const PLAN = pgm(90, 70, (x, y) => (within(x, 5, 85) && within(y, 5, 65) && !(within(x, 44, 47) && y < 40) ? 255 : 0));

test("a picture becomes a world, and so does a map of ROS", () =>
  fresh(async (page) => {
    page.choosesFiles("#open-files", ["small.pgm", pgm(8, 7, () => 0)]);
    await page.says("#scale-size", "8 × 7 pixels");
    page.choosesFiles("#open-files", ["plan.pgm", PLAN]);
    await page.says("#scale-size", "90 × 70 pixels");
    await page.fill("#scale", "0.1");
    await page.says("#scale-size", "9.0 × 7.0 m");
    await page.click("#open-scale .go");
    await page.told("walls, 8.0 × 6.0 m");
    assert.equal((await state()).world, "plan");
    assert.ok(!page.find("#open-dialog").open);
    const yaml =
      "image: p.pgm\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    page.choosesFiles("#open-files", ["m.yaml", Buffer.from(yaml)], ["p.pgm", PLAN]);
    await page.told("walls, 16.0 × 12.0 m");
  }));

test("what cannot be opened says why, and the session goes on", () =>
  fresh(async (page) => {
    await command("step", { ticks: 7 });
    const { state_hash } = await post("situation", {});
    for (const [why, files] of Object.entries({
      "w.json: not JSON: line 2, column 10": { "w.json": '{"format": 1,\n "name": }' },
      "m.yaml: origin is missing": { "m.yaml": "image: p.png\nresolution: zero\n" },
      "a.txt: cannot be imported": { "a.txt": "hello" },
      "v.json: [1]: got [1, 0, 1]; must be": { "v.json": "[[0, 0, 1, 0], [1, 0, 1]]" },
      "one plan at a time": { "a.json": "[]", "b.json": "[]" },
    })) {
      page.choosesFiles("#open-files", ...Object.entries(files));
      await page.says("#open-wrong", why);
      await page.says("#open-wrong", "The robot goes on as before.");
    }
    page.choosesFiles("#open-files", ["black.pgm", pgm(20, 20, () => 0)]);
    await page.click("#open-scale .go");
    await page.says("#open-wrong", "no pixel is floor");
    assert.equal((await post("situation", {})).state_hash, state_hash);
  }, REFUSED));

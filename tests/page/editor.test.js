// The world editor: walls and things are drawn, moved and deleted, by pointer and by key; what cannot be is said.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { path } from "../unit/static/made.js";
import { fresh } from "./page.js";
import { click, drag, edit, says, wallsAre, world, worldIs } from "./plan.js";
import { command, own, state, told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** The editor, open in the office that comes with the program. @param {(page: Page, walls: number) => Promise<void>} use */
const opened = (use) =>
  fresh(
    async (page) => {
      await edit(page);
      await use(page, (await world()).walls.length);
    },
    { expects: / 422 / },
  );

test("a wall is drawn, undone, redone, and saved", () =>
  opened(async (page, count) => {
    const office = await world();
    await page.click("[data-tool=wall]");
    click(page, "1.02 6.03, 2.52 6.03");
    await wallsAre(count + 1);
    const { from, to, panels } = (await world()).walls.at(-1);
    assert.deepEqual([from, to], path("1 6, 2.5 6"));
    assert.ok(panels.length); // looks of its own
    await says(page, "Click where it ends"); // the next one begins there
    click(page, "2.5 7");
    await wallsAre(count + 2);
    await until("both are drawn", () => page.find("#plan .wall")?.getAttribute("d").split("M").length === 3);
    page.press("Escape");
    page.press("z", { ctrl: true });
    await wallsAre(count + 1);
    await page.click("#edit-undo");
    await wallsAre(count);
    await until("nothing is left to undo", () => !page.find("#plan .wall") && page.find("#edit-undo").disabled);
    assert.deepEqual(await world(), office);
    page.press("Z", { ctrl: true, shift: true });
    await wallsAre(count + 1);
    page.press("y", { ctrl: true });
    await wallsAre(count + 2);
    await until("nothing is left to redo", () => page.find("#edit-redo").disabled);
    const download = page.find("#edit-download").getAttribute("href");
    assert.equal((await told(download.replace("/api/", ""))).walls.length, count + 2);

    await page.click("#edit-save");
    await page.fill("#save-name", "office");
    await page.click("#save-form .go");
    await page.says("#save-wrong", "choose another name");
    await page.fill("#save-name", "my-office");
    await page.fill("#save-title", "Mine");
    await page.click("#save-form .go");
    await page.says("#edit-name", /^Mine$/);
    assert.ok(!page.shown("#edit-unsaved"));
    assert.equal(JSON.parse(readFileSync(join(own, "my-office.json"), "utf-8")).walls.length, count + 2);
    assert.equal((await state()).world, "my-office");
    assert.equal(page.all("#world option").at(-1).textContent, "Mine");
  }));

test("things of every kind are drawn, moved and deleted", () =>
  opened(async (page) => {
    for (const [tool, points] of Object.entries({
      door: "8 1, 9 1",
      lamp: "5 5",
      box: "0.5 3, 1 3.5",
      person: "1 4.5, 4 4.5",
      zone: "6 6, 8 6, 8 7",
      start: "9 4, 9 5",
      place: "0.5 5",
    })) {
      await page.click(`[data-tool=${tool}]`);
      click(page, points);
      if (tool === "person" || tool === "zone") await page.click("#edit-finish");
      await until(`the ${tool} is chosen`, () => page.shown("#fields"));
    }
    const { doors, people, slow_zones, starts, boxes } = await world();
    assert.deepEqual([doors[0].hinge, doors[0].width, doors[0].angle_deg], [[8, 1], 1, 0]);
    assert.deepEqual(people[0].path, path("1 4.5, 4 4.5"));
    assert.deepEqual(slow_zones[0].corners, path("6 6, 8 6, 8 7"));
    assert.equal(starts.at(-1).heading_deg, 90);
    assert.deepEqual([boxes[0].x, boxes[0].y, boxes[0].width, boxes[0].depth], [0.75, 3.25, 0.5, 0.5]);

    await page.click("[data-tool=select]");
    drag(page, "0.75 3.25, 0.75 2.25");
    await worldIs("the box is moved", (now) => now.boxes[0].y === 2.25);
    await page.fill("#fields [data-key=width]", "0.8");
    await worldIs("the box is wider", (now) => now.boxes[0].width === 0.8);
    page.find("#plan").focus();
    page.press("Delete");
    await worldIs("the box is gone", (now) => now.boxes === undefined);
    await page.click("[data-tool=delete]");
    click(page, "5 5");
    await worldIs("the lamp is gone", ({ lamps }) => lamps === undefined);
    await until("it is drawn so", () => !page.find("#plan .bulb"));
    click(page, "5 5");
    await says(page, "There is nothing to delete here.");
  }));

test("lines of the script follow the thing that they are about", () =>
  opened(async (page) => {
    const add = (/** @type {string} */ list, /** @type {object} */ item) =>
      command("edit_world", { steps: [{ do: "add", list, item }] });
    await add("doors", { name: "lab", hinge: [8, 1], angle_deg: 0, width: 1 });
    for (const at_s of [5, 7]) await add("script", { at_s, do: "close_door", name: "lab" });
    await page.click("#edit-time");
    await until("the page has both", () => page.all("#script-lines li[data-number]").length === 2);
    await page.click("#time-close");
    click(page, "8.5 1");
    await page.fill("#fields [data-key=name]", "kitchen");
    await worldIs("the lines have the new name", ({ script }) =>
      script.every((/** @type {any} */ one) => one.name === "kitchen"),
    );
    await page.click("#fields .remove");
    await says(page, "Door and 2 lines of the script deleted. Ctrl+Z brings it back.");
    await worldIs("both are gone", ({ script, doors }) => !script?.length && !doors);
    await page.click("#edit-undo");
    await worldIs("both are back", ({ script, doors }) => script?.length === 2 && doors.length === 1);
  }));

test("a door makes its own gap, corners stay closed, and leaving what is edited asks first", () =>
  opened(async (page, count) => {
    await page.click("[data-tool=wall]");
    drag(page, "1 4.5, 4 4.5");
    await wallsAre(count + 1);
    page.press("Escape");
    await page.click("[data-tool=door]");
    click(page, "2 4.5, 3 4.5");
    await wallsAre(count + 2);
    const halves = (await world()).walls.slice(-2).flatMap((/** @type {Wall} */ wall) => [wall.from, wall.to]);
    assert.deepEqual(halves, path("1 4.5, 2 4.5, 3 4.5, 4 4.5"));
    await page.click("#edit-undo"); // one step: door and gap
    await wallsAre(count + 1);
    await page.click("[data-tool=select]");
    click(page, "10 7.5"); // the outer wall on the right, to show its grips
    drag(page, "10 8, 10.5 8");
    await worldIs("the corner is moved", ({ walls }) => walls[1].to[0] === 10.5);
    const outer = (await world()).walls.filter((/** @type {Wall} */ wall) => wall.outer);
    for (const [k, wall] of outer.entries()) assert.deepEqual(wall.to, outer[(k + 1) % outer.length].from);

    await until("it is told", () => page.shown("#edit-unsaved"));
    for (const [answer, left] of [
      ["stay", "office"],
      ["leave", "loop"],
    ]) {
      await page.fill("#world", "loop");
      await page.click(`#leave-dialog [value=${answer}]`);
      await until(`one is in the ${left}`, async () => (await state()).world === left);
    }
    assert.equal((await state()).tick, 0);
  }));

test("a wall onto the robot is refused, and nothing changes; the keyboard alone draws another", () =>
  fresh(async (page) => {
    await command("kidnap", { x: 5, y: 4, heading_rad: 0 });
    await edit(page);
    const before = [await world(), (await state()).robot];
    await page.click("[data-tool=wall]");
    click(page, "4.5 4, 5.5 4");
    await says(page, "The wall would cover the robot at (5.00, 4.00)");
    assert.equal(page.find("#plan-status").className, "bad");
    assert.deepEqual([await world(), (await state()).robot], before);
    assert.equal(page.all("#plan .dot").length, 0);
    await page.click("[data-tool=door]");
    click(page, "1 1, 1.25 1");
    await says(page, "A door is 0.3 to 6 m wide; this one would be 0.25 m.");
    await page.click("#edit-close");

    await command("kidnap", { x: 1, y: 1, heading_rad: 0 });
    page.press("o");
    await until("the plan is drawn", () => page.find("#plan .outer"));
    const count = (await world()).walls.length;
    page.find("#plan").focus();
    page.press("w");
    page.press("Enter");
    for (const key of ["ArrowRight", "ArrowRight"]) page.press(key);
    page.press("ArrowUp", { shift: true });
    await says(page, " m. Click where it ends");
    page.press("Enter");
    await wallsAre(count + 1);
    const { from, to } = (await world()).walls.at(-1);
    assert.deepEqual([to[0] - from[0], to[1] - from[1]], [0.5, 1.25]);
    for (const key of ["Escape", "v", "Escape"]) page.press(key);
    assert.ok(!page.shown("#editor"));
    assert.equal(page.document.activeElement?.id, "edit");
  }));

test("edits of two pages meet; people, boxes and lamps are drawn as they are now", () =>
  opened(async (page) => {
    await command("edit_world", { steps: [{ do: "add", list: "places", item: { name: "somewhere", x: 5, y: 5 } }] });
    await until("the place is drawn", () => page.all("#plan .name").some((name) => name.textContent === "somewhere"));
    await command("reset", { world: "living" });
    const { people } = (await state()).living;
    const heads = () => page.all("#plan .head").map((head) => head.getAttribute("cx"));
    const body = () => page.find("#plan .body").getAttribute("cx");
    await until("all are drawn", () => heads().length === people);
    assert.equal(page.all("#plan .box.away").length, 1); // the trolley, which comes at 5:00
    const [before, still] = [heads(), body()];
    await command("step", { ticks: 30 });
    await until("all have moved", () => body() !== still && String(heads()) !== String(before));
    await command("set_lamp", { name: "hall east", on: false });
    await until("the lamp is off", () => page.text("#plan .bulb.off title") === "hall east, off");
    await command("set_parameter", { name: "office.people", value: false });
    await command("step", { ticks: 1 });
    await until("all are gone", () => heads().length === 0);
    await command("set_parameter", { name: "office.people", value: true });
  }));

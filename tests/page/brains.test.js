// Two brains compared: two clicks begin it, the strip tells how they differ, one click ends it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh } from "./page.js";
import { command, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** @param {Page} page */
const menu = (page) => page.push("Compare brains");

test("two clicks begin it and one ends it", () =>
  fresh(async (page) => {
    assert.ok(!page.shown("#beside"));
    await menu(page);
    await page.click("#brains-anew button", "Without vision");
    await page.told("Two brains, the same senses");
    await until("both can be looked at", () => page.button("Both"));
    await command("step", { ticks: 300 });
    const { experiences, beside } = await state();
    await page.says("#beside-first", "with vision");
    await page.says("#beside-first", String(experiences));
    await page.says("#beside-second", "without vision");
    await until("they differ in what they see", () => page.button("view 0:00.0"));
    const view = page.button("view 0:00.0");
    assert.equal(view.title, "Since tick 0: with vision sees view #0, without vision no view. Show that moment.");
    assert.equal(page.find("#beside-changed summary").title, "local_view.enabled: on → off");
    await page.click("#beside-changed summary");
    assert.equal(page.text("#beside-changed tbody tr"), "local_view.enabledonoff");
    page.press("Escape");
    assert.ok(!page.shown("#beside-changed tbody"));
    assert.deepEqual(beside.changed, [{ name: "local_view.enabled", first: true, second: false }]);
    await page.click(view);
    await until("that moment is shown", async () => (await state()).tick === 1 && page.shown("#past"));
    page.press("n");
    await until("now is shown", async () => (await state()).tick === 300);
    await page.push("End the comparison");
    await until("it is over", () => !page.shown("#beside"));
    page.press("v");
    await page.says("#event-list", "the comparison ends: after 30 s with vision");
  }));

test("the menu names what would really begin", async () => {
  const cells = async (/** @type {number} */ value) => {
    for (const axis of ["x", "y"]) await command("set_parameter", { name: `pose_cells.n_${axis}`, value });
  };
  await fresh(async (page) => {
    await command("use_preset", { name: "paper-2006" });
    await cells(8);
    await menu(page);
    const titles = () => page.all("#brains-anew button > span:first-child").map((words) => words.textContent);
    const wanted = ["Ours", "Without vision", "64 x 64 pose cells", "Learning rate 0.0015", "No map, as in 2004"];
    await until(`the menu offers ${wanted}`, () => String(titles()) === String(wanted));
    await page.click("#brains-anew button", "64 x 64 pose cells");
    await page.told("Two brains, the same senses");
    await page.says("#beside-first", "8 x 8 cells");
    await page.says("#beside-second", "64 x 64 cells");
    await command("end_comparison");
    await command("use_preset", { name: "ours" });
    await cells(64);
  });
});

test("one addition is chosen by its name, and the strip tells what differs", () =>
  fresh(async (page) => {
    const chosen = "#brains-addition";
    await menu(page);
    await page.choose(chosen, "exact solver");
    await page.says("#brains-about", ": sweeps alone lag behind a growing map.");
    assert.ok(!page.shown("#brains-addition-now"));
    await page.choose(chosen, "pace floor");
    await page.says("#brains-addition-now", /^From now on without it$/);
    await page.click("#brains-addition-anew", "Begin again without it");
    await page.told("Two brains, the same senses");
    await page.says("#beside-first", "ours");
    await page.says("#beside-second", "without pace floor");
    await page.click("#beside-changed summary");
    await page.says("#beside-changed thead", "without pace floor");
    await page.says("#beside-changed tbody tr", /^experience_map.pace_flooronoff$/);
    page.press("Escape");
    await command("end_comparison");
    await command("set_parameter", { name: "experience_map.pace_floor", value: false });
    await menu(page);
    assert.equal(page.find(chosen).value, "pace floor");
    await page.says("#brains-addition-now", /^From now on with it$/);
    await page.click("#brains-addition-now");
    await page.says("#beside-second", "with pace floor");
    await until(
      "it is told",
      () => page.find("#beside-changed summary").title === "experience_map.pace_floor: off → on",
    );
    await command("end_comparison");
    await command("set_parameter", { name: "experience_map.pace_floor", value: true });
  }));

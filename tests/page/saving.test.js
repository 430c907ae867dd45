// What a person takes away: the map for other programs, pictures of the plates, a brain that comes back.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh } from "./page.js";
import { command, long, post, state, told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** @param {Page} page */
async function exports(page) {
  await page.click("#restart summary");
  await page.push("Export this run");
  await until("the formats are there", () => page.all("#export-list button").length > 5);
}

/** What went down to a file last. @param {Page} page @returns {Promise<Blob>} */
const saved = async (page) => page.window.saved.at(-1);

test("the map is saved for other programs", () =>
  fresh(async (page) => {
    await command("step", { ticks: 50 });
    await exports(page);
    await page.click("#export-list button", "GraphML");
    await page.told("Saved run-office-seed5.graphml.");
    const graph = await (await saved(page)).text();
    assert.equal(graph.split("<node ").length - 1, (await state()).experiences);
    assert.ok(!page.find("#export-dialog").open);
    await exports(page);
    await page.click("#export-list button", "PNG");
    await until("the pictures are there", () => page.window.saved.length === 2);
    assert.equal(await (await saved(page)).slice(0, 2).text(), "PK"); // an archive
  }));

test("a stretch between two marks, and a file that is given up", long, () =>
  fresh(async (page) => {
    await command("step", { ticks: 60 });
    await command("loop", { begin_s: 1, end_s: 3 });
    await until("the page has the marks", () => page.shown("#loop-off"));
    await exports(page);
    assert.deepEqual([page.find("#export-from").value, page.find("#export-until").value], ["1.0", "3.0"]);
    assert.ok(page.shown("#export-marks"));
    await page.click("#export-list button", "MCAP: ROS 2");
    await page.click("#export-cancel");
    await page.told("The mcap was not written.");
    await until("nothing is written", () => !page.shown("#export-busy"));
    await until("the server has given it up", async () => (await told("exports/done")) === null);
    await page.fill("#export-pictures", "none");
    await page.click("#export-list button", "MCAP: ROS 2");
    await page.told("Saved run-office-seed5-1s-to-3s.mcap.");
    await command("loop");
  }),
);

test("each plate is saved as a picture of vectors, with the moment in its name", () =>
  fresh(async (page) => {
    await command("step", { ticks: 200 });
    await page.says("#clock", "0:20");
    for (const [words, what] of [
      ["Office as SVG", "office"],
      ["Pose cells as SVG", "pose"],
      ["Experience map as SVG", "map"],
    ]) {
      const before = page.window.saved.length;
      await page.click("#keep summary");
      await page.push(words, "#keep");
      await page.told(`Saved office-seed5-0m20.0s-${what}.svg.`);
      assert.equal(page.window.saved.length, before + 1);
      const picture = await (await saved(page)).text();
      assert.match(picture, /^(<\?xml[^>]*>\s*)?<svg [^>]*width="1000/);
      assert.ok(picture.split("<").length > 60, what);
    }
  }));

test("a brain goes down to a file and comes up again; what is none is refused", () =>
  fresh(
    async (page) => {
      await command("step", { ticks: 600 });
      const { experiences } = await state();
      const { state_hash } = await post("situation", {});
      page.choosesFiles("#brain-file", ["cat.npz", "a picture of a cat"]);
      await page.told("This file is no brain");
      assert.equal((await post("situation", {})).state_hash, state_hash);
      const brain = await (await fetch(page.find("#brain-save").href)).bytes();
      page.choosesFiles("#brain-file", ["brain.npz", brain]);
      await page.told("Started anew with the brain");
      const now = await until("it begins again", async () => (await state()).tick === 0 && state());
      assert.ok(now.experiences >= experiences);
    },
    { expects: / 422 / },
  ));

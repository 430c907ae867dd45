// The gallery of experiments: one is watched, an order of one's own ends it, and who waits is told for what.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh } from "./page.js";
import { command, state, told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

test("one is watched, and an order of one's own ends it", () =>
  fresh(async (page) => {
    const table = (await told("experiments")).find((/** @type {Card} */ card) => card.name === "table");
    await page.click("#experiments");
    const card = ".card[data-name=table]";
    await page.says(`${card} h3`, table.title);
    await page.says(`${card} .asks`, table.asks);
    await page.fill(`${card} select`, "paper");
    await page.click(`${card} .go`);
    await page.told(`Watching: ${table.title}.`);
    assert.ok(!page.find("#gallery-dialog").open);
    for (const words of [table.title, "the paper's rules", "exploring", "of about 22:00"])
      await page.says("#trial", words);
    await until("it runs", async () => (await state()).time_s > 0.3);
    const { running, trial } = await state();
    assert.deepEqual([running, trial.engine, trial.levels], [true, "paper", ["0 %", "64 x 64"]]);
    page.press("k");
    await page.says("#trial", "ended: somebody carried the robot away");
    await page.click("#trial-again");
    await page.says("#trial", "exploring");
    await command("pause");
    await command("watch_experiment", { experiment: "table", moment_s: 1300 });
    await page.says("#trial", "going to the moment");
    await page.click("#trial-here");
    await page.says("#trial", "exploring");
    const now = await until("it goes no further", async () => (await state()).trial.ahead === null && state());
    assert.deepEqual([now.running, now.trial.state], [true, "running"]);
    assert.ok(now.time_s < 1290);
    await page.click("#trial-close");
    await until("the card is away", () => !page.shown("#trial"));
    await command("reset", { seed: 3 });
    assert.equal((await state()).trial, null);
  }));

test("one is found by a figure, and a trial that fell short is played from its moment", () =>
  fresh(async (page) => {
    page.answers("/api/experiments/table", (/** @type {ExperimentDetail} */ { card, results }) => {
      const dot = { id: "", seed: 5, quick: false, good: 3, of: 3, words: "3 of 3", moment_s: 1250, moment: "printer" };
      const dots = [dot, { ...dot, seed: 9, good: 1, words: "1 of 3" }];
      const cells = results.cells.map((cell) => ({ ...cell, n: 2, words: "67 % (30-90)", dots }));
      return { card, results: { ...results, cells } };
    });
    await page.click("#lessons");
    await page.click("#lessons-experiments");
    await until("they are there", () => page.all(".card").length > 9);
    page.fill("#gallery-search", "figure 12");
    await until("few are left", () => page.all(".card:not([hidden])").length < 6);
    await page.click(".card[data-name=table] .trials");
    await page.says("#cell-words", "1 of them fell short.");
    await page.click("#cell-short");
    await page.says("#trial", "going to the moment");
    const { seed, engine, levels } = (await state()).trial;
    assert.deepEqual([seed, engine, levels], [9, "ours", ["0 %", "64 x 64"]]);
    await command("reset", { seed: 3 });
  }));

test("there and back, by keyboard", () =>
  fresh(async (page) => {
    page.answers("/api/experiments/table", (/** @type {ExperimentDetail} */ { card, results }) => {
      const cells = results.cells.map((cell) => ({ ...cell, n: 0, words: "", dots: [] }));
      return { card, results: { ...results, cells } };
    });
    page.press("g");
    await page.click(".card[data-name=table] .trials");
    await until("its cells are there", () => page.all("#one-grid .cell").length > 4);
    assert.equal(page.document.activeElement?.id, "gallery-back");
    assert.ok(page.shown("#cell-none")); // nothing was run
    await page.click("#one-grid .cell[aria-label^='2 %, 8 x 8']");
    await page.says("#cell-title", "2 %, 8 x 8, our rules");
    assert.equal(page.all(".dot").length, 10); // each plays its trial, from the start
    await page.click("#gallery-back");
    assert.equal(page.document.activeElement?.className, "trials");
    await page.click("#gallery-close");
    assert.ok(!page.find("#gallery-dialog").open);
  }));

test("a refusal is said where one looks, and who waits is told for what", () =>
  fresh(async (page) => {
    page.answers("/api/experiments", (/** @type {Card[]} */ cards) => [...cards, { ...cards[0], name: "castle" }]);
    page.press("g");
    await page.click(".card[data-name=castle] .go");
    await page.says("#gallery-wrong", "There is no experiment 'castle'; expected one of: ");
    assert.ok(page.find("#gallery-dialog").open);
    const asked = page.holds((sent) => sent.type === "watch_experiment"); // the engine may still be compiled
    await page.click(".card[data-name=table] .go");
    await page.says("#gallery-wait", "It begins in a moment.");
    page.hear({ type: "waking", doing: "compiling the engine" });
    await page.says("#gallery-wait", "First the engine wakes up: compiling the engine.");
    page.find(".card[data-name=table] .go").click(); // once is enough
    assert.equal(asked.length, 1);
    asked[0]();
    await until("it begins", () => !page.find("#gallery-dialog").open);
    await command("pause");
  }));

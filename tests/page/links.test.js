// A moment as a person shares it: a link, a file; and the second screen, where whatever is done changes nothing.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh, open } from "./page.js";
import { command, post, state, until, url } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** @param {Page} page */
const isTheSame = (page) => until("it is the same", () => page.find("#situation").dataset.state === "same");

test("a link leads to the same moment, bit for bit, with the same tab and view; what is no link is said", () =>
  fresh(async (page) => {
    await command("step", { ticks: 100 });
    await command("kidnap", { x: 2, y: 6 });
    await command("step", { ticks: 50 });
    await page.says("#clock", "0:15");
    await page.tab("Memory");
    await page.click("[data-view=pose]");
    await page.click("#keep summary");
    await page.push("Link to this moment");
    const link = await until("there is a link", () => page.shown("#share-dialog") && page.find("#share-link").value);
    await page.says("#share-length", `${link.length} characters`);
    const { robot } = await state();
    const { state_hash } = await post("situation", {});
    await command("reset", { world: "loop" });
    const broken = { path: "#run=nonsense", expects: /422/ };
    await open((other) => other.told("The link cannot be opened. The link is damaged"), broken);
    await open(
      async (other) => {
        await isTheSame(other);
        await other.says("#situation", `The same, bit for bit: state hash ${state_hash.slice(0, 12)} at tick 150.`);
        assert.equal(other.text("#panel [role=tab][aria-selected=true]"), "Memory");
        assert.equal(other.find("[data-view=pose]").getAttribute("aria-pressed"), "true");
        assert.equal(other.window.location.href, url); // a reload changes nothing
        const now = await state();
        assert.deepEqual([now.tick, now.robot], [150, robot]);
        await other.click("#situation-close");
        assert.ok(!other.shown("#situation"));
      },
      { path: link.slice(url.length) },
    );
  }));

test("a file leads there, and one that is long can be left", () =>
  fresh(async (page) => {
    await command("step", { ticks: 20 });
    const { file } = await post("situation", {});
    await command("step", { ticks: 30 });
    page.choosesFiles("#open-files", ["a.situation.json", file]);
    await isTheSame(page);
    assert.equal((await state()).tick, 20);
    page.choosesFiles("#open-files", ["long.situation.json", JSON.stringify({ ...JSON.parse(file), tick: 5_000_000 })]);
    await page.says("#situation", "of 5,000,000");
    await page.push("Back to your run", "#situation");
    await until("it is left", async () => (await state()).tick === 20 && !(await state()).running);
  }));

/** The whole session as a hash, the orders that led to it, and all that the page is told of it. */
async function moment() {
  const { state_hash, orders } = await post("situation", {});
  return [state_hash, orders, await state()];
}

test("the second screen: keys, clicks and requests change nothing", () =>
  fresh(async () => {
    await command("step", { ticks: 300 });
    await open(
      async (page) => {
        await page.says("#clock", "0:30");
        const [before, events] = [await moment(), page.text("#events")];
        for (const key of [..."ke .,bjxminhocg/w", "ArrowUp", "PageDown"]) page.press(key);
        page.drag("#timeline", [
          [100, 20],
          [200, 20],
        ]);
        for (const part of page.all("header button, footer button, .aids button")) part.click();
        const mine = new URL(page.window.sockets[0].url).searchParams.get("page") ?? "";
        for (const type of ["kidnap", "resume", "step"]) {
          const headers = { "Content-Type": "application/json", "X-Page": mine };
          const body = JSON.stringify({ type, ticks: 1 });
          assert.equal((await fetch(`${url}api/commands`, { method: "POST", headers, body })).status, 403);
        }
        const types = ["kidnap", "resume", "step", "switch", "end_lesson"];
        const answers = await new Promise((told) => {
          const other = new page.window.WebSocket(`${url.replace("http", "ws")}api/stream?page=${mine}`);
          /** @type {number[]} */
          const said = [];
          other.onopen = () => types.forEach((type, id) => void other.send(JSON.stringify({ type, id, ticks: 1 })));
          other.onmessage = (/** @type {MessageEvent} */ { data }) => {
            const message = typeof data === "string" ? JSON.parse(data) : {};
            if (message.type === "answer") said.push(message.status);
            if (said.length === types.length) told(said);
          };
        });
        assert.deepEqual(
          answers,
          types.map(() => 403),
        );
        assert.deepEqual([await moment(), page.text("#events")], [before, events]);
      },
      { path: "?watch", expects: /403/ },
    );
  }));

test("the second screen shows what the main page shows", () =>
  fresh(async (main) => {
    await command("step", { ticks: 400 });
    await open(
      async (page) => {
        await page.says("#clock", "0:40");
        await command("seek", { time_s: 30 });
        for (const one of [page, main]) await one.says("#past", "0:30");
        assert.deepEqual([page.text("#clock"), main.text("#clock")], ["0:30", "0:30"]);
        main.press("n");
        await until("it is now", () => !page.shown("#past"));
        for (const on of ["true", "false"]) {
          main.press("z");
          await until(`both present: ${on}`, () => page.document.body.dataset.presenter === on);
        }
        await command("begin_lesson", { name: "packet" });
        await page.says("#lesson-title", "A packet moves");
        const asks = async () => (await state()).lesson.state === "predict" && page.find(".option input")?.disabled;
        await until("it asks", asks);
        await command("predict", { choice: 1 });
        await until("it is answered", () => page.all(".option input")[1].checked);
        await command("end_lesson");
        await until("the card is away", () => !page.shown("#lesson"));
        assert.ok(page.find("#world").disabled);
      },
      { path: "?watch" },
    );
  }));

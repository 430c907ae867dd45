// The timeline as a person uses it: drag it, step, come back to now, go on from there, compare branches, name moments.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh } from "./page.js";
import { command, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** A run of a minute with a kidnap in its middle. @param {(page: Page) => Promise<void>} use */
const driven = (use) =>
  fresh(async (page) => {
    await command("step", { ticks: 300 });
    await command("kidnap");
    await command("step", { ticks: 300 });
    await until("the page has it", () => page.find("#timeline").getAttribute("aria-valuenow") === "60.0");
    await use(page);
  });

/** @param {number} tick */
const at = (tick) => until(`tick ${tick}`, async () => (await state()).tick === tick);

/** The page has this moment: a step is counted from what it shows. @param {Page} page @param {number} tick */
async function shows(page, tick) {
  await at(tick);
  const said = `0:${(tick / 10).toFixed(1).padStart(4, "0")} `;
  await until(`the timeline says ${said}`, () =>
    page.find("#timeline").getAttribute("aria-valuetext").startsWith(said),
  );
}

/** Where a time is on the timeline, of about a minute. @param {number} time_s @returns {[number, number]} */
const x = (time_s) => [6 + (1188 * time_s) / 60, 20];

test("what comes last is drawn, however soon it comes after what went before", () =>
  fresh(async (page) => {
    const socket = page.window.sockets.at(-1);
    const hear = socket.onmessage;
    /** @type {any} */
    let last;
    socket.onmessage = (/** @type {{ data: string }} */ event) => {
      const message = typeof event.data === "string" ? JSON.parse(event.data) : {};
      if (message.type === "state") last = message;
      hear(event);
    };
    await command("step", { ticks: 10 });
    await shows(page, 10);
    page.hear({ type: "events", run: 1, fresh: false, events: [] }); // drawn at once
    page.hear({ ...last, state: { ...last.state, tick: 11, time_s: 1.1 } });
    await until("it says so", () => page.find("#timeline").getAttribute("aria-valuenow") === "1.1");
  }));

test("drag, step, and come back", () =>
  driven(async (page) => {
    const before = await state();
    let aim = 0;
    page.drag("#timeline", [x(50), x(10), x(20)], () => {
      aim = Math.round(10 * Number(page.find("#timeline").getAttribute("aria-valuenow")));
    });
    assert.ok(aim > 180 && aim < 220, `${aim}`);
    await until("it shows the past", () => page.shown("#past"));
    await page.says("#status", "the past");
    await shows(page, aim); // the last wish of the drag has come true
    assert.ok(!(await state()).running);
    for (let k = 0; k < 5; k++) page.find("#tick-back").click();
    await at(aim - 5);
    for (let k = 0; k < 4; k++) page.find("#tick-on").click();
    await shows(page, aim - 1);
    page.press("l");
    await shows(page, aim + 9);
    page.press("]");
    await shows(page, 300); // the kidnap
    page.find("#timeline").focus();
    page.press("ArrowLeft");
    await shows(page, 299);
    assert.match(page.find("#timeline").getAttribute("aria-valuetext"), /^0:29.9 of 1:00, the past/);
    page.press("k");
    await page.told("This is the past: go on from here, or come back to now");
    page.press("n");
    await until("it is now", () => !page.shown("#past"));
    const after = await state();
    assert.deepEqual([after.tick, after.robot, after.running], [600, before.robot, false]);
  }));

test("what is filtered out is neither listed nor marked; go on without the kidnap, and compare", () =>
  driven(async (page) => {
    page.press("v");
    const marks = () => page.all("#timeline .mark").map((mark) => mark.dataset.kind);
    const turn = () => page.click("#event-kinds [data-kind=kidnap]");
    await until("the kidnap is marked", () => marks().includes("kidnap"));
    await turn();
    const listed = () => page.all("#event-list b").map((kind) => kind.textContent);
    assert.ok(listed().length && !listed().includes("kidnap") && !marks().includes("kidnap"));
    await turn();
    assert.ok(marks().includes("kidnap"));

    await page.push("0:30kidnap", "#event-list");
    await shows(page, 300);
    page.press("v");
    await page.click("#go-on");
    await page.says("#branches [aria-pressed=true]", /^2$/);
    await command("step", { ticks: 100 });
    await page.push("Branches side by side");
    await page.says("#compare-words", "first difference at tick 301");
    assert.equal(page.all(".branch-side").length, 2);
    page.press("Escape");
    await page.push("Branch 1, the run as it began");
    await at(600);
  }));

test("a stretch is played again and again until that is ended", () =>
  driven(async (page) => {
    await command("seek", { tick: 100 });
    await shows(page, 100);
    await page.click("#mark-a");
    await command("seek", { tick: 120 });
    await shows(page, 120);
    await page.click("#mark-b");
    await until("there is a loop", () => page.shown("#loop-off"));
    await until("it is drawn", () => page.all("#timeline .loop").length === 1);
    await page.click("#loop-off");
    await until("there is none", () => !page.shown("#loop-off"));
    page.press("n");
    await at(600);
  }));

test("a moment is named by a key, gone to, shared, and deleted", () =>
  fresh(async (page) => {
    await command("step", { ticks: 100 });
    page.press("m");
    const name = "[aria-label='Name of the bookmark']";
    await until("its name can be written", () => page.document.activeElement === page.find(name));
    await page.fill(name, "before the door");
    page.press("Enter");
    await page.says("#bookmark-list li", "before the door");
    await until("it is marked", () => page.all("#timeline .bookmark").length === 1);
    await command("step", { ticks: 50 });
    await page.click("#bookmark-list .go-there");
    await at(100);
    await page.push("Link to before the door");
    await page.says("#share-words", "tick 100,");
    await page.click("#share-close");
    await page.push("Another name for before the door");
    await page.fill(name, "the door");
    page.press("Escape");
    await page.says("#bookmark-list li", "before the door");
    assert.ok(page.shown("#events-box"));
    await page.push("Delete before the door");
    await until("it is gone", () => !page.find("#bookmark-list li"));
    await command("back_to_now");
  }));

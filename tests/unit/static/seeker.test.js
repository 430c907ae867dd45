// Moments of the past are asked for one at a time; a newer wish is not kept waiting for long.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Seeker } from "../../../web/static/timeline/seeker.js";

/** A connection that answers when it is told to. */
class Link {
  constructor() {
    /** @type {number[]} */
    this.asked = [];
    /** @type {(() => void)[]} */
    this.answers = [];
  }
  /** @param {Seek} wish @returns {Promise<void>} */
  ask(wish) {
    this.asked.push(wish.tick ?? -1);
    return new Promise((answer) => this.answers.push(answer));
  }
}

/** @returns {[Seeker, Link]} */
function made() {
  const link = new Link();
  return [new Seeker(/** @type {any} */ (link)), link];
}

/** Lets so much time pass. @param {import("node:test").TestContext} context @param {number} ms */
async function pass(context, ms) {
  for (let gone = 0; gone < ms; gone += 5) {
    context.mock.timers.tick(5);
    for (let turn = 0; turn < 8; turn++) await null;
  }
}

/** Time is what the timers say. @param {import("node:test").TestContext} context */
function stopClocks(context) {
  context.mock.timers.enable({ apis: ["setTimeout", "Date"], now: 0 });
  context.mock.method(performance, "now", () => Date.now());
}

test("while one moment is on its way, only the newest wish waits", async (context) => {
  stopClocks(context);
  const [seeker, link] = made();
  for (const tick of [1, 2, 3]) seeker.seek({ tick });
  assert.deepEqual(link.asked, [1]);
  link.answers[0]?.();
  await pass(context, 10);
  assert.deepEqual(link.asked, [1, 3]);
  link.answers[1]?.();
  await pass(context, 10);
  assert.equal(seeker.busy, false);
  seeker.told();
  assert.equal(seeker.aim, null);
});

test("during a drag a moment that takes long is given up after a while, so that others are seen on the way", async (context) => {
  stopClocks(context);
  const [seeker, link] = made();
  seeker.seek({ tick: 0 });
  for (let tick = 1; tick <= 10; tick++) {
    await pass(context, 10);
    seeker.seek({ tick });
    assert.deepEqual(link.asked, [0]);
  }
  for (let tick = 11; tick <= 18; tick++) {
    await pass(context, 10);
    seeker.seek({ tick });
  }
  assert.equal(link.asked.length, 2);
});

test("where the pointer has come to rest, the moment there does not wait for another", async (context) => {
  stopClocks(context);
  const [seeker, link] = made();
  seeker.seek({ tick: 1 });
  await pass(context, 10);
  seeker.seek({ tick: 2 });
  await pass(context, 15);
  assert.deepEqual(link.asked, [1]);
  await pass(context, 50);
  assert.deepEqual(link.asked, [1, 2]);
});

test("of a slow drag at least every second moment is waited for", async (context) => {
  stopClocks(context);
  const [seeker, link] = made();
  for (let tick = 0; tick < 6; tick++) {
    seeker.seek({ tick });
    await pass(context, 40);
  }
  assert.deepEqual(link.asked, [0, 1, 5]); // 1 is given up after its patience, not at the next rest
  link.answers[2]?.();
  await pass(context, 20);
  seeker.seek({ tick: 6 });
  await pass(context, 10);
  seeker.seek({ tick: 7 });
  await pass(context, 50);
  assert.deepEqual(link.asked, [0, 1, 5, 6, 7]);
});

test("without another wish a moment may take as long as it takes", async (context) => {
  stopClocks(context);
  const [seeker, link] = made();
  seeker.seek({ tick: 7 });
  await pass(context, 1000);
  assert.deepEqual(link.asked, [7]);
  assert.equal(seeker.busy, true);
});

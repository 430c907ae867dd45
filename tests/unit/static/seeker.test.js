// Moments of the past are asked for one at a time; a newer wish is not kept waiting for long.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Seeker } from "../../../web/static/timeline/tools.js";

/** A seeker whose connection answers when it is told to, and a time that is what the timers say.
 * @param {import("node:test").TestContext} context */
function made(context) {
  context.mock.timers.enable({ apis: ["setTimeout", "Date"], now: 0 });
  context.mock.method(performance, "now", () => Date.now());
  const [asked, answers] = [/** @type {number[]} */ ([]), /** @type {(() => void)[]} */ ([])];
  const ask = (/** @type {Seek} */ wish) => {
    asked.push(wish.tick ?? -1);
    return new Promise((/** @type {(none: void) => void} */ answer) => answers.push(answer));
  };
  const pass = async (/** @type {number} */ ms) => {
    for (let gone = 0; gone < ms; gone += 5) {
      context.mock.timers.tick(5);
      for (let turn = 0; turn < 8; turn++) await null;
    }
  };
  return { seeker: new Seeker(/** @type {any} */ ({ ask })), asked, answers, pass };
}

test("while one moment is on its way, only the newest wish waits", async (context) => {
  const { seeker, asked, answers, pass } = made(context);
  for (const tick of [1, 2, 3]) seeker.seek({ tick });
  assert.deepEqual(asked, [1]);
  answers[0]?.();
  await pass(10);
  assert.deepEqual(asked, [1, 3]);
  answers[1]?.();
  await pass(10);
  assert.equal(seeker.busy, false);
  seeker.onMoment();
  assert.equal(seeker.aim, null);
});

test("during a drag a moment that takes long is given up after a while, so that others are seen on the way", async (context) => {
  const { seeker, asked, pass } = made(context);
  seeker.seek({ tick: 0 });
  for (let tick = 1; tick <= 10; tick++) {
    await pass(10);
    seeker.seek({ tick });
    assert.deepEqual(asked, [0]);
  }
  for (let tick = 11; tick <= 18; tick++) {
    await pass(10);
    seeker.seek({ tick });
  }
  assert.equal(asked.length, 2);
});

test("where the pointer has come to rest, the moment there does not wait for another, which may take long", async (context) => {
  const { seeker, asked, pass } = made(context);
  seeker.seek({ tick: 1 });
  await pass(10);
  seeker.seek({ tick: 2 });
  await pass(15);
  assert.deepEqual(asked, [1]);
  await pass(50);
  assert.deepEqual(asked, [1, 2]);
  await pass(1000); // without another wish
  assert.deepEqual([asked, seeker.busy], [[1, 2], true]);
});

test("of a slow drag at least every second moment is waited for", async (context) => {
  const { seeker, asked, answers, pass } = made(context);
  for (let tick = 0; tick < 6; tick++) {
    seeker.seek({ tick });
    await pass(40);
  }
  assert.deepEqual(asked, [0, 1, 5]); // 1 is given up after its patience, not at the next rest
  answers[2]?.();
  await pass(20);
  seeker.seek({ tick: 6 });
  await pass(10);
  seeker.seek({ tick: 7 });
  await pass(50);
  assert.deepEqual(asked, [0, 1, 5, 6, 7]);
});

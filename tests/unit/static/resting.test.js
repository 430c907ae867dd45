// The loop of frames rests after each as long as it took, where that is software's work, and while the editor covers it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { restBetweenFrames } from "../../../web/static/viewer/viser_client.js";

const FRAME_MS = 16;

/** A window whose time goes on by itself: what waits in it is done in the order of its time. */
class Inside extends EventTarget {
  constructor() {
    super();
    this.at = 0;
    this.last = 0;
    /** @type {Map<number, { at: number, step: (at: number) => void }>} */
    this.waiting = new Map();
    this.performance = { now: () => this.at };
  }
  /** @param {(at: number) => void} step @param {number} ms */
  setTimeout(step, ms) {
    this.waiting.set(++this.last, { at: this.at + ms, step });
    return this.last;
  }
  /** @param {number} id */
  clearTimeout(id) {
    this.waiting.delete(id);
  }
  /** @param {(at: number) => void} step */
  requestAnimationFrame(step) {
    return this.setTimeout(step, FRAME_MS - (this.at % FRAME_MS));
  }
  /** @param {number} id */
  cancelAnimationFrame(id) {
    this.waiting.delete(id);
  }
  /** @param {number} until */
  pass(until) {
    for (;;) {
      const [first] = [...this.waiting].sort(([, a], [, b]) => a.at - b.at);
      if (!first || first[1].at > until) break;
      const [id, next] = first;
      this.waiting.delete(id);
      this.at = next.at;
      next.step(this.at);
    }
    this.at = until;
  }
}

/** A context that has drawn everything so many milliseconds after it was asked. @param {Inside} inside @param {number} takes_ms */
function slow(inside, takes_ms) {
  return {
    SIGNALED: 1,
    flush: () => {},
    deleteSync: () => {},
    isContextLost: () => false,
    fenceSync: () => ({ at: inside.at + takes_ms }),
    getSyncParameter: (/** @type {{ at: number }} */ fence) => Number(inside.at >= fence.at),
  };
}

/** @param {number | null} takes_ms null: with a graphics card */
function drawn(takes_ms, covered = () => false) {
  const inside = new Inside();
  const gl = takes_ms === null ? null : slow(inside, takes_ms);
  const wake = restBetweenFrames(/** @type {any} */ (inside), covered, () => /** @type {any} */ (gl));
  /** @type {number[]} */
  const at = [];
  const loop = () => {
    inside.requestAnimationFrame(loop);
    at.push(inside.at);
  };
  inside.requestAnimationFrame(loop);
  inside.pass(1000);
  at.length = 0;
  return { inside, wake, at };
}

/** How many frames it draws in the ten seconds in which something happens again and again. @param {() => Event | null} event */
function whileIn(event) {
  const { inside, at } = drawn(160);
  for (let k = 0; k < 20; k++) {
    const happens = event();
    if (happens) inside.dispatchEvent(happens);
    inside.pass(inside.at + 500);
  }
  return at.length;
}
const pointer = (/** @type {number} */ buttons) => Object.assign(new Event("pointermove"), { buttons });
const AS_LONG = 10_000 / 320; // frames that take 160 ms and are followed by as long a rest

test("in software it rests as long as a frame took; only who turns the camera does not wait", () => {
  const [alone, passing, turning] = [() => null, () => pointer(0), () => pointer(1)].map(whileIn);
  assert.ok(alone >= 25 && alone <= AS_LONG, `${alone}`);
  assert.ok(passing <= AS_LONG, `${passing}`);
  assert.ok(turning > 50, `${turning}`);
});

test("with a graphics card every frame is drawn, and a context that never tells that it has drawn holds nothing up", () => {
  const card = drawn(null);
  card.inside.pass(2000);
  assert.equal(card.at.length, Math.floor(2000 / FRAME_MS) - Math.floor(1000 / FRAME_MS));
  const silent = drawn(Infinity);
  silent.inside.pass(20_000);
  assert.ok(silent.at.length > 500, `${silent.at.length}`);
});

test("beneath the editor it draws once in two seconds, and at once when it closes", () => {
  let covered = false;
  const { inside, wake, at } = drawn(null, () => covered);
  covered = true;
  inside.pass(9000);
  assert.ok(at.length >= 4 && at.length <= 6, `${at.length}`);
  covered = false;
  at.length = 0;
  wake();
  inside.pass(9000 + 2 * FRAME_MS);
  assert.ok(at.length > 0);
});

test("what is held is given up when it is cancelled, and who cancels without having asked stops nothing", () => {
  const { inside, at } = drawn(160);
  let ran = false;
  const other = () => (ran = true);
  for (let k = 0; k < 30; k++) inside.cancelAnimationFrame(inside.requestAnimationFrame(other));
  for (let k = 0; k < 100; k++) {
    for (const none of [0, -1, /** @type {any} */ (null), undefined]) inside.cancelAnimationFrame(none);
    inside.pass(inside.at + 50);
  }
  assert.ok(at.length > 4000 / 400, `${at.length}`);
  assert.equal(ran, false);
});

test("after each frame of the loop it is said that it is drawn", () => {
  const { inside, at } = drawn(160);
  let said = 0;
  inside.addEventListener("drawn", () => said++);
  inside.pass(5000);
  assert.equal(said, at.length);
});

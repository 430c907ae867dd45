import assert from "node:assert/strict";
import { test } from "node:test";

import { Gesture, pinched } from "../../../web/static/model/pinch.js";

const CAMERA = { distance: 12, unit: 0.004 };

/** @param {number} ax @param {number} ay @param {number} bx @param {number} by @returns {import("../../../web/static/model/pinch.js").Fingers} */
const pair = (ax, ay, bx, by) => [
  [ax, ay],
  [bx, by],
];

/** @param {number} a @param {number} b */
const same = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a}, not ${b}`);

test("fingers four times as far apart bring the camera four times nearer", () => {
  assert.deepEqual(pinched(pair(-30, 0, 30, 0), pair(-120, 0, 120, 0), CAMERA), { distance: 3, right: 0, down: 0 });
});

test("what lay between the fingers lies between them", () => {
  const { distance, right, down } = pinched(pair(60, -40, 140, -60), pair(0, 10, 100, 110), CAMERA);
  const [was, is] = [CAMERA.unit * CAMERA.distance, CAMERA.unit * distance];
  same(100 * was, right + 50 * is);
  same(-50 * was, down + 60 * is);
});

test("many small steps come to the same as a large one", () => {
  const at = (/** @type {number} */ k) => pair(-30 - k, 5 * k, 30 + 3 * k, 20);
  const camera = { ...CAMERA };
  const sum = { right: 0, down: 0 };
  for (let k = 0; k < 30; k++) {
    const { distance, right, down } = pinched(at(k), at(k + 1), camera);
    camera.distance = distance;
    sum.right += right;
    sum.down += down;
  }
  const whole = pinched(at(0), at(30), CAMERA);
  same(camera.distance, whole.distance);
  same(sum.right, whole.right);
  same(sum.down, whole.down);
});

test("fingers on one another move nothing", () => {
  assert.equal(pinched(pair(5, 5, 5, 5), pair(5, 5, 5, 5), CAMERA).distance, CAMERA.distance);
});

test("where a finger is lifted counts, also just after the other", () => {
  const gesture = new Gesture();
  gesture.down(7, [0, 0]);
  assert.equal(gesture.move(7, [1, 0]), null);
  gesture.down(8, [50, 0]);
  assert.deepEqual(gesture.move(8, [100, 0]), [pair(1, 0, 50, 0), pair(1, 0, 100, 0)]);
  assert.deepEqual(gesture.up(7, [1, 0]), [pair(1, 0, 100, 0), pair(1, 0, 100, 0)]);
  assert.deepEqual(gesture.up(8, [200, 0]), [pair(1, 0, 100, 0), pair(1, 0, 200, 0)]);
  assert.equal(gesture.fingers, 0);
  assert.equal(gesture.has(8), false);
});

test("a finger that stays pinches no more until another comes", () => {
  const gesture = new Gesture();
  gesture.down(1, [0, 0]);
  gesture.down(2, [10, 0]);
  gesture.up(1, null);
  assert.equal(gesture.move(2, [90, 0]), null);
  assert.equal(gesture.fingers, 1);
  gesture.down(3, [0, 0]);
  assert.deepEqual(gesture.move(3, [40, 0]), [pair(90, 0, 0, 0), pair(90, 0, 40, 0)]);
});

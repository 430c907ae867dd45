import assert from "node:assert/strict";
import { test } from "node:test";

import { pinched } from "../../../web/static/model/pinch.js";

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

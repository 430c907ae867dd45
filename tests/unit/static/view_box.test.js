// Metres to pixels and back on the editor's plan; and two fingers that bring the stage's camera nearer.

import assert from "node:assert/strict";
import { test } from "node:test";
import { away } from "../../../web/static/editor/geometry.js";
import { pinched } from "../../../web/static/viewer/viser_client.js";
import { ViewBox } from "../../../web/static/editor/plan.js";
import { chance, path, points, segment } from "./made.js";

const RING = path("-2 1, 8 1, 8 6, -2 6");
const fitted = (width = 700, height = 500) => {
  const box = new ViewBox();
  box.fit(RING, width, height);
  return box;
};

test("what is fitted is all in sight, in the middle, as large as can be", () => {
  for (const [width, height] of path("700 500, 300 900, 1600 200")) {
    const pixels = RING.map((p) => fitted(width, height).pixel(p));
    const [us, vs] = [0, 1].map((k) => pixels.map((pixel) => pixel[k]));
    const rims = [Math.min(...us), width - Math.max(...us), Math.min(...vs), height - Math.max(...vs)];
    assert.ok(Math.abs(rims[0] - rims[1]) < 1e-6 && Math.abs(rims[2] - rims[3]) < 1e-6);
    assert.ok(Math.abs(Math.min(...rims) - 36) < 1e-6, String(rims));
  }
});

test("a pixel's metres are at that pixel, wherever the sheet was moved; north is up", () => {
  const [box, next] = [fitted(), chance(2)];
  for (const p of points(100)) {
    box.pan(next() * 40 - 20, next() * 40 - 20);
    box.zoom(0.8 + next() * 0.45, [next() * 700, next() * 500]);
    assert.ok(away(box.metres(box.pixel(p)), p) < 1e-6);
    assert.ok(box.pixel([p[0], p[1] + 1])[1] < box.pixel(p)[1]);
  }
});

test("what is under the pointer stays there while it becomes larger, up to a limit", () => {
  const box = fitted();
  const [p, was] = [box.metres([123, 45]), box.scale];
  box.zoom(1.7, [123, 45]);
  assert.ok(Math.abs(box.scale / was - 1.7) < 1e-12);
  assert.ok(away(box.pixel(p), [123, 45]) < 1e-6);
  for (const [factor, limit] of path("1e9 2000, 1e-12 0.1")) {
    box.zoom(factor, [123, 45]);
    assert.equal(box.scale, limit);
    assert.ok(away(box.pixel(p), [123, 45]) < 1e-3);
  }
});

test("a point out of sight is pushed in, one in sight is left", () => {
  const box = fitted();
  assert.deepEqual(box.push(box.metres([350, 250]), 700, 500), [0, 0]);
  for (const pixel of path("-50 250, 900 10, 350 600, 23 477")) {
    const moved = fitted();
    const p = moved.metres(pixel);
    moved.pan(...moved.push(p, 700, 500));
    const [x, y] = moved.pixel(p);
    assert.ok(x >= 24 - 1e-6 && x <= 676 + 1e-6 && y >= 24 - 1e-6 && y <= 476 + 1e-6, `${pixel}: ${x}, ${y}`);
  }
});

test("lines of the grid keep seven pixels apart and stay on whole metres from one metre on", () => {
  for (const asked of [0.05, 0.1, 0.25, 0.5, 1])
    for (let scale = 0.1; scale < 2000; scale *= 1.4) {
      const box = fitted();
      box.scale = scale;
      const { fine, coarse } = box.gridSteps(asked);
      assert.ok(fine * scale >= 7 && coarse >= fine && fine >= asked);
      assert.ok(fine < 1 || Number.isInteger(Math.round(fine * 1e9) / 1e9), `${asked} ${scale}: ${fine}`);
      if (asked * scale >= 7) assert.equal(fine, asked);
    }
});

const CAMERA = { distance: 12, unit: 0.004 };
const same = (/** @type {number} */ a, /** @type {number} */ b) => assert.ok(Math.abs(a - b) < 1e-9, `${a}, not ${b}`);

test("fingers four times as far apart bring the camera four times nearer, on one another nowhere", () => {
  const wider = pinched(segment("-30 0, 30 0"), segment("-120 0, 120 0"), CAMERA);
  assert.deepEqual(wider, { distance: 3, right: 0, down: 0 });
  assert.equal(pinched(segment("5 5, 5 5"), segment("5 5, 5 5"), CAMERA).distance, CAMERA.distance);
});

test("what lay between the fingers lies between them", () => {
  const { distance, right, down } = pinched(segment("60 -40, 140 -60"), segment("0 10, 100 110"), CAMERA);
  const [was, is] = [CAMERA.unit * CAMERA.distance, CAMERA.unit * distance];
  same(100 * was, right + 50 * is);
  same(-50 * was, down + 60 * is);
});

test("many small steps come to the same as a large one", () => {
  const at = (/** @type {number} */ k) => segment(`${-30 - k} ${5 * k}, ${30 + 3 * k} 20`);
  const sum = { ...CAMERA, right: 0, down: 0 };
  for (let k = 0; k < 30; k++) {
    const { distance, right, down } = pinched(at(k), at(k + 1), sum);
    Object.assign(sum, { distance, right: sum.right + right, down: sum.down + down });
  }
  const whole = pinched(at(0), at(30), CAMERA);
  for (const key of /** @type {const} */ (["distance", "right", "down"])) same(sum[key], whole[key]);
});

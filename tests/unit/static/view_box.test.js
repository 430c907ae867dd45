// Metres to pixels and back.

import assert from "node:assert/strict";
import { test } from "node:test";
import { away } from "../../../web/static/model/geometry.js";
import { ViewBox } from "../../../web/static/model/view_box.js";
import { chance, points } from "./chance.js";

/** @type {Point[]} */
const RING = [
  [-2, 1],
  [8, 1],
  [8, 6],
  [-2, 6],
];
const fitted = () => {
  const box = new ViewBox();
  box.fit(RING, 700, 500);
  return box;
};

test("what is fitted is all in sight, in the middle, as large as can be", () => {
  for (const [width, height] of [
    [700, 500],
    [300, 900],
    [1600, 200],
  ]) {
    const box = new ViewBox();
    box.fit(RING, width, height);
    const [us, vs] = [RING.map((p) => box.pixel(p)[0]), RING.map((p) => box.pixel(p)[1])];
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
  for (const [factor, limit] of [
    [1e9, 2000],
    [1e-12, 0.1],
  ]) {
    box.zoom(factor, [123, 45]);
    assert.equal(box.scale, limit);
    assert.ok(away(box.pixel(p), [123, 45]) < 1e-3);
  }
});

test("a point out of sight is pushed in, one in sight is left", () => {
  const box = fitted();
  assert.deepEqual(box.push(box.metres([350, 250]), 700, 500), [0, 0]);
  for (const [u, v] of /** @type {Point[]} */ ([
    [-50, 250],
    [900, 10],
    [350, 600],
    [23, 477],
  ])) {
    const moved = fitted();
    const p = moved.metres([u, v]);
    moved.pan(...moved.push(p, 700, 500));
    const [x, y] = moved.pixel(p);
    assert.ok(x >= 24 - 1e-6 && x <= 676 + 1e-6 && y >= 24 - 1e-6 && y <= 476 + 1e-6, `${u}, ${v}: ${x}, ${y}`);
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

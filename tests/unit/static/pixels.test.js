// Laws of the pictures that the panel draws.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  STRIP,
  bars,
  fromAbove,
  mix,
  picture,
  rgb,
  viewStrip,
  viewsASquare,
} from "../../../web/static/model/pixels.js";
import { chance } from "./chance.js";

/** @typedef {import("../../../web/static/model/pixels.js").Pixels} Pixels */
/** @typedef {import("../../../web/static/model/pixels.js").Rgb} Rgb */

/** @param {Pixels} pixels @param {number} x @param {number} y */
const at = ({ width, rgba }, x, y) => [...rgba.slice(4 * (y * width + x), 4 * (y * width + x) + 4)];

test("colours are read as they are written in the style", () => {
  assert.deepEqual(rgb(" #ffc04d"), [255, 192, 77]);
  assert.deepEqual(rgb("#fff"), [255, 255, 255]);
  assert.deepEqual(mix([0, 0, 0], [10, 20, 30], 0.5), [5, 10, 15]);
});

test("a picture's pixels are its values, grey or coloured", () => {
  assert.deepEqual(at(picture([1, 2, 3, 4, 5, 6], [2, 3]), 2, 1), [6, 6, 6, 255]);
  assert.deepEqual(at(picture([1, 2, 3, 4, 5, 6], [1, 2, 3]), 1, 0), [4, 5, 6, 255]);
});

test("every view has a square of the strip, however many there are", () => {
  for (const views of [0, 1, 203, 204, 205, 2040, 20_000]) {
    assert.ok(Math.floor(Math.max(views - 1, 0) / viewsASquare(views)) < STRIP.rows * STRIP.columns);
  }
});

test("the active view is lit, those of late fade, the rest is quiet", () => {
  /** @type {{ quiet: Rgb, lit: Rgb, active: Rgb, ground: Rgb }} */
  const colours = { quiet: [9, 9, 9], lit: [200, 100, 0], active: [1, 2, 3], ground: [0, 0, 0] };
  const strip = viewStrip({ views: 100, active: 40, recent: [3, 7, 40] }, colours);
  const middle = (/** @type {number} */ view) => {
    const [x, y] = [(view % STRIP.columns) * STRIP.square + 2, Math.floor(view / STRIP.columns) * STRIP.square + 2];
    return at(strip, x, y);
  };
  assert.deepEqual(middle(40), [1, 2, 3, 255]);
  assert.ok(middle(7)[0] > middle(3)[0]); // the younger is the brighter
  assert.deepEqual(middle(50), [9, 9, 9, 60]);
  assert.deepEqual(middle(150), [9, 9, 9, 18]);
  assert.equal(at(strip, STRIP.square - 1, 0)[3], 0); // a gap between squares
});

test("activity from above: the strongest column is opaque, the front row is at the bottom, packets mix by weight", () => {
  /** @type {Rgb[]} */
  const colours = [
    [200, 0, 0],
    [0, 0, 200],
  ];
  const pixels = fromAbove([2, 3], [1, 1, 5], [0, 1, 7], [3, 1, 1], colours, [9, 9, 9]);
  assert.deepEqual(at(pixels, 1, 1), [150, 0, 50, 255]); // place 1 is in the front row
  assert.deepEqual(at(pixels, 2, 0).slice(0, 3), [0, 0, 200]); // a higher rank has the last colour
  assert.ok(at(pixels, 2, 0)[3] < 255);
  assert.deepEqual(at(pixels, 0, 0), [9, 9, 9, 28]);
});

test("bars stand on the floor, the tallest to the top, and what is nearly nothing is not drawn", () => {
  assert.equal(bars([0, 0]), "");
  const next = chance(3);
  for (let k = 0; k < 50; k++) {
    const values = Array.from({ length: 36 }, () => next() ** 8);
    const tops = [...bars(values).matchAll(/V([\d.-]+)h/g)].map(([, top]) => Number(top));
    assert.equal(Math.abs(Math.min(...tops)), 0);
    assert.ok(tops.every((top) => top > -0.01 && top < 100));
  }
});

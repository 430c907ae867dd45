// Pictures that the panel draws, a plot as SVG, and the names and words of moments.

import assert from "node:assert/strict";
import { test } from "node:test";
import { linkIn, momentWords, situationWords } from "../../../web/static/share/share.js";
import { nameOfMoment } from "../../../web/static/share/keeping.js";
import * as draw from "../../../web/static/panel/parts.js";
import { plotSvg, ticksIn } from "../../../web/static/share/pictures.js";
import { chance } from "./made.js";
import { fromAbove, STRIP, viewsASquare, viewStrip } from "../../../web/static/panel/senses.js";

/** @typedef {import("../../../web/static/panel/parts.js").Pixels} Pixels */
/** @typedef {import("../../../web/static/panel/parts.js").Rgb} Rgb */

/** @param {Pixels} pixels @param {number} x @param {number} y */
const at = ({ width, rgba }, x, y) => [...rgba.slice(4 * (y * width + x), 4 * (y * width + x) + 4)];

test("colours are read as they are written in the style; a picture's pixels are its values, grey or coloured", () => {
  assert.deepEqual(draw.rgb(" #ffc04d"), [255, 192, 77]);
  assert.deepEqual(draw.rgb("#fff"), [255, 255, 255]);
  assert.deepEqual(draw.mix([0, 0, 0], [10, 20, 30], 0.5), [5, 10, 15]);
  assert.deepEqual(at(draw.picture([1, 2, 3, 4, 5, 6], [2, 3]), 2, 1), [6, 6, 6, 255]);
  assert.deepEqual(at(draw.picture([1, 2, 3, 4, 5, 6], [1, 2, 3]), 1, 0), [4, 5, 6, 255]);
});

test("every view has a square of the strip, however many there are", () => {
  for (const views of [0, 1, 203, 204, 205, 2040, 20_000])
    assert.ok(Math.floor(Math.max(views - 1, 0) / viewsASquare(views)) < STRIP.rows * STRIP.columns);
});

test("the active view is lit, those of late fade, the rest is quiet", () => {
  /** @type {{ quiet: Rgb, lit: Rgb, active: Rgb, ground: Rgb }} */
  const colours = { quiet: [9, 9, 9], lit: [200, 100, 0], active: [1, 2, 3], ground: [0, 0, 0] };
  const strip = viewStrip({ views: 100, active: 40, recent: [3, 7, 40] }, colours);
  const { columns, square } = STRIP;
  const middle = (/** @type {number} */ view) =>
    at(strip, (view % columns) * square + 2, Math.floor(view / columns) * square + 2);
  assert.deepEqual(middle(40), [1, 2, 3, 255]);
  assert.ok(middle(7)[0] > middle(3)[0]); // the younger is the brighter
  assert.deepEqual(middle(50), [9, 9, 9, 60]);
  assert.deepEqual(middle(150), [9, 9, 9, 18]);
  assert.equal(at(strip, square - 1, 0)[3], 0); // a gap between squares
});

test("activity from above: the strongest column is opaque, the front row is at the bottom, packets mix by weight", () => {
  const colours = ["#c80000", "#0000c8"].map(draw.rgb);
  const pixels = fromAbove([2, 3], [1, 1, 5], [0, 1, 7], [3, 1, 1], colours, [9, 9, 9]);
  assert.deepEqual(at(pixels, 1, 1), [150, 0, 50, 255]); // place 1 is in the front row
  assert.deepEqual(at(pixels, 2, 0).slice(0, 3), [0, 0, 200]); // a higher rank has the last colour
  assert.ok(at(pixels, 2, 0)[3] < 255);
  assert.deepEqual(at(pixels, 0, 0), [9, 9, 9, 28]);
});

test("bars stand on the floor, the tallest to the top, and what is nearly nothing is not drawn", () => {
  assert.equal(draw.bars([0, 0]), "");
  const next = chance(3);
  for (let k = 0; k < 50; k++) {
    const values = Array.from({ length: 36 }, () => next() ** 8);
    const tops = [...draw.bars(values).matchAll(/V([\d.-]+)h/g)].map(([, top]) => Number(top));
    assert.equal(Math.abs(Math.min(...tops)), 0);
    assert.ok(tops.every((top) => top > -0.01 && top < 100));
  }
});

const inks = { paper: "#000", text: "#fff", second: "#999", rim: "#333" };
const lines = [
  { label: "map (m)", colour: "#4cc9f0" },
  { label: "odometry <m>", colour: "#ff7a3d", dash: [6, 4] },
];
const plot = (/** @type {number[][]} */ ...columns) => plotSvg("Errors & more", "office, seed 5", columns, lines, inks);
const found = (/** @type {string} */ svg, /** @type {RegExp} */ pattern) => [...svg.matchAll(pattern)].map((m) => m[1]);

test("a plot: its line has all its points and breaks where one is missing; without values it is a plot", () => {
  const svg = plot([0, 1, 2, 3], [0, 1, NaN, 2], [4, 4, 4, 4]);
  const [first, , second] = found(svg, /<path d="([^"]+)" fill="none" stroke="#(?:4cc9f0|ff7a3d)"/g);
  assert.equal((first.match(/M/g) ?? []).length, 2);
  assert.equal((second.match(/[ML]/g) ?? []).length, 4);
  assert.ok(svg.includes("Errors &amp; more") && svg.includes("odometry &lt;m&gt;"));
  for (const made of [svg, plot([]), plot([], [], []), plot([1], [NaN], [NaN])]) assert.ok(!/NaN|Infinity/.test(made));
});

test("a plot has round numbers around all values, and round times", () => {
  assert.deepEqual(ticksIn(0, 1), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticksIn(0, 12), [0, 2, 4, 6, 8, 10, 12]);
  assert.ok(ticksIn(0, 0.00031).length >= 4);
  const svg = plot([0, 150, 300], [0.1, 3.4, 2], [0, 1, -0.3]);
  const words = found(svg, /<text[^>]*>([^<]*)</g);
  for (const one of ["-1", "0", "4", "0:00", "1:00", "4:00", "time (min:s)", "office, seed 5"])
    assert.ok(words.includes(one), one);
  assert.equal(found(svg, /(stroke)="#(?:4cc9f0|ff7a3d)"/g).length, 4);
  assert.ok(Math.min(...found(svg, /[ML][\d.]+ ([\d.]+)/g).map(Number)) >= 56);
});

test("names tell run and moment, a link is found in an address, and nothing else", () => {
  assert.equal(nameOfMoment("office", 5, 0), "office-seed5-0m00.0s");
  assert.equal(nameOfMoment("my office/2", 5, 754.3), "my-office-2-seed5-12m34.3s");
  assert.equal(nameOfMoment(null, 1, 60), "recording-seed1-1m00.0s");
  assert.equal(linkIn("#run=abc"), "run=abc");
  for (const hash of ["", "#", "#run=", "#running=1", "run=abc"]) assert.equal(linkIn(hash), null);
});

test("what is said of a moment", () => {
  const look = /** @type {any} */ ({});
  const at = /** @type {const} */ ({ tick: 50, end_tick: 2000, words: "done", state_hash: "", look });
  assert.deepEqual(situationWords({ ...at, state: "playing" }), {
    title: "Playing up to the moment",
    words: "tick 50 of 2,000",
    share: 0.025,
  });
  assert.equal(situationWords({ ...at, state: "same" }).words, "done");
  assert.equal(situationWords({ ...at, state: "same", end_tick: 0 }).share, 1);
  const moment = /** @type {any} */ ({ tick: 5, state_hash: "abcdef0123456789", orders: 1 });
  assert.match(momentWords(moment, "0:00.5"), /tick 5, with one order\. .* state hash abcdef012345\./);
});

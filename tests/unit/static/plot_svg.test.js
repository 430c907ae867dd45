// A plot as SVG, and the names that files get.

import assert from "node:assert/strict";
import { test } from "node:test";
import { linkIn, momentWords, nameOfMoment, situationWords } from "../../../web/static/model/moments.js";
import { plotSvg, ticksIn } from "../../../web/static/model/plot_svg.js";

const inks = { paper: "#000", text: "#fff", second: "#999", rim: "#333" };
const lines = [
  { label: "map (m)", colour: "#4cc9f0" },
  { label: "odometry <m>", colour: "#ff7a3d", dash: [6, 4] },
];

test("ticks are round and cover the range", () => {
  assert.deepEqual(ticksIn(0, 1), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticksIn(0, 12), [0, 2, 4, 6, 8, 10, 12]);
  assert.ok(ticksIn(0, 0.00031).length >= 4);
});

test("a line has all its points and breaks where one is missing", () => {
  const svg = plotSvg(
    "Errors & more",
    "office-seed5",
    [
      [0, 1, 2, 3],
      [0, 1, NaN, 2],
      [4, 4, 4, 4],
    ],
    lines,
    inks,
  );
  const [first, , second] = [...svg.matchAll(/<path d="([^"]+)" fill="none" stroke="#(?:4cc9f0|ff7a3d)"/g)].map(
    (m) => m[1],
  );
  assert.equal((first.match(/M/g) ?? []).length, 2);
  assert.equal((second.match(/[ML]/g) ?? []).length, 4);
  assert.ok(svg.includes("Errors &amp; more") && svg.includes("odometry &lt;m&gt;"));
  assert.ok(!/NaN|Infinity/.test(svg));
});

test("round numbers around all values, and round times", () => {
  const columns = [
    [0, 150, 300],
    [0.1, 3.4, 2],
    [0, 1, -0.3],
  ];
  const svg = plotSvg("Errors", "office, seed 5", columns, lines, inks);
  const words = [...svg.matchAll(/<text[^>]*>([^<]*)</g)].map((m) => m[1]);
  for (const tick of ["-1", "0", "4", "0:00", "1:00", "4:00"]) assert.ok(words.includes(tick), tick);
  assert.ok(words.includes("time (min:s)") && words.includes("office, seed 5"));
  const tops = [...svg.matchAll(/stroke="#(?:4cc9f0|ff7a3d)"/g)].length;
  const ys = [...svg.matchAll(/[ML][\d.]+ ([\d.]+)/g)].map((m) => Number(m[1]));
  assert.equal(tops, 4);
  assert.ok(Math.min(...ys) >= 56);
});

test("a plot without values is a plot", () => {
  for (const columns of [[[]], [[], [], []], [[1], [NaN], [NaN]]])
    assert.ok(!/NaN|Infinity/.test(plotSvg("Errors", "run", columns, lines, inks)));
});

test("names tell run and moment", () => {
  assert.equal(nameOfMoment("office", 5, 0), "office-seed5-0m00.0s");
  assert.equal(nameOfMoment("my office/2", 5, 754.3), "my-office-2-seed5-12m34.3s");
  assert.equal(nameOfMoment(null, 1, 60), "recording-seed1-1m00.0s");
});

test("a link is found in an address, and nothing else", () => {
  assert.equal(linkIn("#run=abc"), "run=abc");
  for (const hash of ["", "#", "#run=", "#running=1", "run=abc"]) assert.equal(linkIn(hash), null);
});

test("what the note says", () => {
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

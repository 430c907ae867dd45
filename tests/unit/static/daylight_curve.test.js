// The curve of the daylight in its picture.

import assert from "node:assert/strict";
import { test } from "node:test";
import { BOTTOM, DaylightCurve, HEIGHT, LEFT, RIGHT, TOP, WIDTH } from "../../../web/static/model/daylight_curve.js";

/** @param {Point[]} points @param {number} [repeat_s] */
const curve = (points, repeat_s = 0) => new DaylightCurve({ points, repeat_s });
const places = (/** @type {string} */ path) =>
  path
    .slice(1)
    .split("L")
    .map((pair) => pair.split(" ").map(Number));

test("all of it is in the picture, from its left to its right", () => {
  for (const made of [
    curve([
      [0, 1],
      [600, 0],
      [900, 3],
    ]),
    curve([[100, 2]], 90),
    curve([[5, 0]]),
    new DaylightCurve(null),
  ]) {
    const drawn = places(made.path);
    assert.deepEqual([drawn[0][0], drawn.at(-1)?.[0]], [LEFT, WIDTH - RIGHT]);
    for (const [x, y] of drawn)
      assert.ok(x >= LEFT && x <= WIDTH - RIGHT && y >= TOP && y <= HEIGHT - BOTTOM, made.path);
  }
});

test("before its first point it is as at the first, after the last as at the last, without any as painted", () => {
  const made = curve([
    [60, 0.5],
    [120, 2],
  ]);
  const drawn = places(made.path);
  assert.deepEqual([drawn[0][1], drawn[1][1]], [drawn[1][1], Number(made.y(0.5).toFixed(1))]);
  assert.equal(drawn.at(-1)?.[1], drawn.at(-2)?.[1]);
  const none = new DaylightCurve(null);
  assert.deepEqual(
    places(none.path).map(([, y]) => y),
    [1, 1].map((level) => Number(none.y(level).toFixed(1))),
  );
});

test("later is further right, brighter is higher", () => {
  const made = curve([
    [0, 1],
    [600, 2],
  ]);
  assert.ok(made.x(10) < made.x(20) && made.y(1) > made.y(1.5));
  assert.equal(made.x(99_999), WIDTH - RIGHT); // a moment past the end stays at the end
});

test("one that repeats begins its round again", () => {
  const made = curve(
    [
      [0, 1],
      [50, 0],
    ],
    100,
  );
  assert.equal(made.now(130), made.now(30));
  assert.equal(made.span_s, 100);
  const once = curve([
    [0, 1],
    [80, 0],
  ]);
  assert.equal(once.now(130), WIDTH - RIGHT);
});

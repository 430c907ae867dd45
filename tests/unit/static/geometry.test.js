// Laws of points and lines, over many of them from a generator with a seed.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  at,
  away,
  corners,
  degrees,
  hinge,
  point,
  tip,
  toArea,
  toPath,
  toSegment,
  turned,
  within,
} from "../../../web/static/model/geometry.js";
import { points } from "./chance.js";

const near = (/** @type {number} */ a, /** @type {number} */ b, by = 1e-9) =>
  assert.ok(Math.abs(a - b) <= by, `${a} is not within ${by} of ${b}`);

test("what is at a point lies on the millimetre and no further than half of one from it", () => {
  for (const [x, y] of points(200)) {
    const [u, v] = at(x, y);
    assert.ok(Math.abs(u - x) <= 0.0005 + 1e-12 && Math.abs(v - y) <= 0.0005 + 1e-12);
    assert.deepEqual(at(u, v), [u, v]);
  }
});

test("turning keeps lengths, adds up, and comes back after a whole turn", () => {
  for (const p of points(100)) {
    near(Math.hypot(...turned(p, 37)), Math.hypot(...p));
    const [twice, once] = [turned(turned(p, 20), 50), turned(p, 70)];
    near(away(twice, once), 0);
    near(away(turned(p, 360), p), 0);
  }
  const [x, y] = turned([1, 0], 90);
  near(x, 0);
  near(y, 1); // counter-clockwise
});

test("a direction is that of the turned x axis", () => {
  for (const angle of [-179.9, -90, -0.1, 0, 45, 90, 180])
    near(degrees([2, 3], [2 + turned([5, 0], angle)[0], 3 + turned([5, 0], angle)[1]]), angle);
});

test("a segment is as far as the nearest of many points along it", () => {
  const many = points(90);
  for (let k = 0; k < many.length; k += 3) {
    const [p, a, b] = many.slice(k, k + 3);
    const along = Array.from({ length: 2001 }, (_, i) =>
      point(a[0] + ((b[0] - a[0]) * i) / 2000, a[1] + ((b[1] - a[1]) * i) / 2000),
    );
    near(toSegment(p, a, b), Math.min(...along.map((q) => away(p, q))), away(a, b) / 2000);
  }
  assert.equal(toSegment([3, 4], [0, 0], [0, 0]), 5); // of no length
});

test("a path is as far as its nearest segment, and one point is a path", () => {
  assert.equal(toPath([3, 4], [[0, 0]]), 5);
  assert.equal(
    toPath(
      [1, 1],
      [
        [0, 0],
        [2, 0],
        [2, 3],
      ],
    ),
    1,
  );
  assert.equal(
    toPath(
      [0, 2],
      [
        [0, 0],
        [2, 0],
        [2, 3],
      ],
    ),
    2,
  ); // it is open
});

test("inside is inside, also of a shape with a bay", () => {
  /** @type {Point[]} */
  const bay = [
    [0, 0],
    [4, 0],
    [4, 4],
    [3, 4],
    [3, 1],
    [1, 1],
    [1, 4],
    [0, 4],
  ];
  for (const [p, inside] of /** @type {[Point, boolean][]} */ ([
    [[0.5, 3], true],
    [[2, 0.5], true],
    [[2, 2], false],
    [[3.5, 3], true],
    [[5, 2], false],
    [[-1, 1], false],
  ])) {
    assert.equal(within(p, bay), inside, String(p));
    assert.equal(toArea(p, bay) === 0, inside, String(p));
  }
  assert.equal(toArea([2, 2], bay), 1);
  assert.equal(toArea([-2, 4], bay), 2); // the last side counts
});

/** @type {Door} */
const door = { name: "d", hinge: [1, 2], angle_deg: 0, width: 0.9, swing_deg: -90 };

test("a leaf turns about its hinge by its swing", () => {
  assert.deepEqual(
    [tip(door), tip(door, 1)],
    [
      [1.9, 2],
      [1, 1.1],
    ],
  );
  assert.deepEqual(tip({ ...door, swing_deg: undefined }, 1), [1, 2.9]); // 90 where it is not said
  for (const opening of [0, 0.3, 1]) near(away(hinge(door, opening), tip(door, opening)), 0.9, 0.002);
});

test("a sliding leaf goes back by its width and keeps it", () => {
  const sliding = { ...door, slides: true };
  assert.deepEqual(
    [hinge(sliding), tip(sliding)],
    [
      [1, 2],
      [1.9, 2],
    ],
  );
  assert.deepEqual(
    [hinge(sliding, 1), tip(sliding, 1)],
    [
      [0.1, 2],
      [1, 2],
    ],
  );
});

test("a box has its sides and its middle, however it is turned", () => {
  for (const angle_deg of [0, 30, 90, 211]) {
    const [a, b, c, d] = corners({ x: 3, y: -1, width: 2, depth: 1, angle_deg });
    for (const [one, other, side] of /** @type {[Point, Point, number][]} */ ([
      [a, b, 2],
      [b, c, 1],
      [c, d, 2],
      [d, a, 1],
    ]))
      near(away(one, other), side, 0.003);
    near(away(point((a[0] + c[0]) / 2, (a[1] + c[1]) / 2), [3, -1]), 0, 0.002);
  }
  assert.deepEqual(corners({ x: 0, y: 0, width: 2, depth: 1 })[0], [-1, -0.5]);
});

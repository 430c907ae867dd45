// Laws of points and lines, over many of them from a generator with a seed.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as plane from "../../../web/static/editor/geometry.js";
import { path, points } from "./made.js";

const { away, turned } = plane;
const near = (/** @type {number} */ a, /** @type {number} */ b, by = 1e-9) =>
  assert.ok(Math.abs(a - b) <= by, `${a} is not within ${by} of ${b}`);

test("what is at a point lies on the millimetre and no further than half of one from it", () => {
  for (const [x, y] of points(200)) {
    const [u, v] = plane.at(x, y);
    near(u, x, 0.0005 + 1e-12);
    near(v, y, 0.0005 + 1e-12);
    assert.deepEqual(plane.at(u, v), [u, v]);
  }
});

test("turning keeps lengths, adds up, goes counter-clockwise and comes back after a whole turn", () => {
  for (const p of points(100)) {
    near(Math.hypot(...turned(p, 37)), Math.hypot(...p));
    near(away(turned(turned(p, 20), 50), turned(p, 70)), 0);
    near(away(turned(p, 360), p), 0);
  }
  near(away(turned([1, 0], 90), [0, 1]), 0);
  for (const angle of [-179.9, -90, -0.1, 0, 45, 90, 180]) {
    const [x, y] = turned([5, 0], angle);
    near(plane.degrees([2, 3], [2 + x, 3 + y]), angle);
  }
});

test("a segment is as far as the nearest of many points along it", () => {
  const many = points(90);
  for (let k = 0; k < many.length; k += 3) {
    const [p, a, b] = many.slice(k, k + 3);
    const along = Array.from({ length: 2001 }, (_, i) =>
      plane.point(a[0] + ((b[0] - a[0]) * i) / 2000, a[1] + ((b[1] - a[1]) * i) / 2000),
    );
    near(plane.toSegment(p, a, b), Math.min(...along.map((q) => away(p, q))), away(a, b) / 2000);
  }
  assert.equal(plane.toSegment([3, 4], [0, 0], [0, 0]), 5); // of no length
});

test("a path is as far as its nearest segment, is open, and one point is a path", () => {
  const bent = path("0 0, 2 0, 2 3");
  assert.deepEqual([plane.toPath([1, 1], bent), plane.toPath([0, 2], bent)], [1, 2]);
  assert.equal(plane.toPath([3, 4], path("0 0")), 5);
});

test("inside is inside, also of a shape with a bay", () => {
  const bay = path("0 0, 4 0, 4 4, 3 4, 3 1, 1 1, 1 4, 0 4");
  const wanted = [true, true, true, false, false, false];
  const asked = path("0.5 3, 2 0.5, 3.5 3, 2 2, 5 2, -1 1");
  assert.deepEqual(
    asked.map((p) => plane.within(p, bay)),
    wanted,
  );
  assert.deepEqual(
    asked.map((p) => plane.toArea(p, bay) === 0),
    wanted,
  );
  assert.deepEqual([plane.toArea([2, 2], bay), plane.toArea([-2, 4], bay)], [1, 2]); // the last side counts
});

test("a leaf turns about its hinge by its swing, a sliding one goes back by its width; both keep it", () => {
  /** @type {Door} */
  const door = { name: "d", hinge: [1, 2], angle_deg: 0, width: 0.9, swing_deg: -90 };
  const ends = (/** @type {Door} */ leaf, opening = 0) => [plane.hinge(leaf, opening), plane.tip(leaf, opening)];
  assert.deepEqual(ends(door), path("1 2, 1.9 2"));
  assert.deepEqual(ends(door, 1), path("1 2, 1 1.1"));
  assert.deepEqual(plane.tip({ ...door, swing_deg: undefined }, 1), [1, 2.9]); // 90 where it is not said
  for (const opening of [0, 0.3, 1]) near(away(plane.hinge(door, opening), plane.tip(door, opening)), 0.9, 0.002);
  const sliding = { ...door, slides: true };
  assert.deepEqual(ends(sliding), path("1 2, 1.9 2"));
  assert.deepEqual(ends(sliding, 1), path("0.1 2, 1 2"));
});

test("a box has its sides and its middle, however it is turned", () => {
  for (const angle_deg of [0, 30, 90, 211]) {
    const box = plane.corners({ x: 3, y: -1, width: 2, depth: 1, angle_deg });
    for (const k of [0, 1, 2, 3]) near(away(box[k], box[(k + 1) % 4]), k % 2 ? 1 : 2, 0.003);
    near(away(plane.point((box[0][0] + box[2][0]) / 2, (box[0][1] + box[2][1]) / 2), [3, -1]), 0, 0.002);
  }
  assert.deepEqual(plane.corners({ x: 0, y: 0, width: 2, depth: 1 })[0], [-1, -0.5]);
});

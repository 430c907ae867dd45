// The list of places that can be gone to.

import assert from "node:assert/strict";
import { test } from "node:test";
import { choices, whereabouts } from "../../../web/static/model/places.js";

const robot = { x: 1, y: 1, heading_rad: Math.PI / 2 };

test("a place is where the robot would point to", () => {
  assert.equal(whereabouts(robot, { x: 1, y: 4 }), "3.0 m ahead");
  assert.equal(whereabouts(robot, { x: -1, y: 1 }), "2.0 m to the left");
  assert.equal(whereabouts(robot, { x: 13, y: 1 }), "12 m to the right");
  assert.equal(whereabouts(robot, { x: 2, y: 0 }), "1.4 m behind to the right");
  assert.equal(whereabouts(robot, { x: 1.1, y: 1 }), "here");
});

const places = {
  robot,
  to_goal: false,
  tags: [{ name: "the printer", experience: 7, x: 4, y: 1 }],
  named: [
    { name: "kitchen", experience: null, x: null, y: null, why: "the robot has not been near it yet" },
    { name: "library", experience: 3, x: 5, y: 1, why: null },
  ],
  experiences: [
    { id: 3, x: 5, y: 1, seconds: null },
    { id: 7, x: 4, y: 1, seconds: 12.4 },
  ],
};

test("named places come first, then the nearest experiences", () => {
  assert.deepEqual(
    choices(places, "", 9).map(({ title, where }) => `${title}: ${where}`),
    [
      "the printer: 3.0 m to the right",
      "library: 4.0 m to the right",
      "kitchen: the robot has not been near it yet",
      "Experience 7: 3.0 m to the right, 12 s",
      "Experience 3: 4.0 m to the right, no way known",
    ],
  );
  assert.equal(choices(places, "", 2).length, 2);
});

test("what is typed is sought in the names", () => {
  assert.deepEqual(
    choices(places, " PRINT", 9).map(({ tag }) => tag),
    ["the printer"],
  );
  assert.deepEqual(
    choices(places, "ence 3", 9).map(({ experience }) => experience),
    [3],
  );
});

test("while nothing is typed, a few experiences stand for those around them", () => {
  const experiences = Array.from({ length: 50 }, (_, id) => ({ id, x: 1 + 0.1 * id, y: 1, seconds: id }));
  const shown = choices({ robot, to_goal: false, tags: [], named: [], experiences }, "", 99);
  assert.deepEqual(
    shown.map(({ experience }) => experience),
    [10, 20, 30, 40],
  );
  assert.equal(choices({ robot, to_goal: false, tags: [], named: [], experiences }, "Experience", 99).length, 50);
});

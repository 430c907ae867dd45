// Two brains in words and figures.

import assert from "node:assert/strict";
import { test } from "node:test";
import { HEADS, MEANS, cellsOf, changedWords, odometryWords, sinceWhen } from "../../../web/static/model/beside.js";

const brain = {
  name: "ours",
  views: 3,
  experiences: 4,
  links: 5,
  relocalisations: 6,
  error_map_m: 0.204,
  off_m: null,
  lost: false,
};

test("each figure has its head, and what is not known is a dash", () => {
  assert.deepEqual(cellsOf(brain), ["4", "5", "6", "0.20 m", "-"]);
  assert.equal(HEADS.length, cellsOf(brain).length);
  assert.ok(Object.keys(MEANS).every((head) => HEADS.includes(head)));
});

test("a difference is a moment to go to", () => {
  const told = sinceWhen({ kind: "view", tick: 268, time_s: 26.8, words: "view #3 is seen as no view" });
  assert.equal(told.button, "view 0:26.8");
  assert.equal(told.title, "Since tick 268: view #3 is seen as no view. Show that moment.");
});

test("without truth odometry alone cannot be judged", () => {
  const beside = {
    first: brain,
    second: brain,
    since_s: 0,
    estimate: { x: 0, y: 0, heading_rad: 0 },
    differences: [],
    changed: [],
  };
  assert.equal(odometryWords({ ...beside, error_odometry_m: null }), "");
  assert.equal(odometryWords({ ...beside, error_odometry_m: 1.5 }), "Odometry alone: 1.50 m");
});

test("what makes the difference is told, from the first brain to the second, and not without end", () => {
  const told = changedWords([{ name: "local_view.enabled", first: true, second: false }]);
  assert.deepEqual(told, { button: "1 parameter", title: "local_view.enabled: on → off" });
  const many = changedWords(Array.from({ length: 9 }, (_, k) => ({ name: `a.b${k}`, first: 0.1 + 0.2, second: "x" })));
  assert.equal(many.button, "9 parameters");
  assert.match(many.title, /^a\.b0: 0\.3 → x\n/);
  assert.match(many.title, /and 3 more$/);
});

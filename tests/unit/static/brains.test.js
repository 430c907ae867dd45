// Two brains in words and figures, and our additions as choices for the second.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  additionChoice,
  additionGroups,
  cellsOf,
  changedWords,
  HEADS,
  MEANS,
  odometryWords,
  sinceWhen,
} from "../../../web/static/viewer/beside.js";
import { ADDITIONS } from "../../../web/static/shared.js";

const names = ADDITIONS.map(({ name }) => name);
const ON = { beginning: [], now: [] };
const counts = { views: 3, experiences: 4, links: 5, relocalisations: 6 };
const brain = { name: "ours", ...counts, error_map_m: 0.204, off_m: null, lost: false };

test("all additions are offered once, and a group that would be empty is not", () => {
  assert.deepEqual(
    additionGroups(ON).map((group) => group.names),
    [names],
  );
  const groups = additionGroups({ beginning: ["pace floor"], now: [] });
  assert.deepEqual([groups.length, groups[1].names], [2, ["pace floor"]]);
  assert.deepEqual(new Set(groups.flatMap((group) => group.names)), new Set(names));
});

test("an addition says what it adds and why, its buttons which way it goes; some begin with a run only", () => {
  const { about, ...buttons } = additionChoice("pace floor", { beginning: ["pace floor"], now: [] });
  assert.match(about, /^A link takes at least as long as .*: a route over many short links would promise/);
  assert.deepEqual(buttons, { anew: "Begin again with it", now: "From now on without it" });
  const { anew, now } = additionChoice("exact solver", ON);
  assert.deepEqual([anew, now], ["Begin again without it", ""]);
});

test("each figure has its head, and what is not known is a dash", () => {
  assert.deepEqual(cellsOf(brain), ["4", "5", "6", "0.20 m", "-"]);
  assert.equal(HEADS.length, cellsOf(brain).length);
  assert.ok(Object.keys(MEANS).every((head) => HEADS.includes(head)));
});

test("a difference is a moment to go to; without truth odometry alone cannot be judged", () => {
  const { button, title } = sinceWhen({ kind: "view", tick: 268, time_s: 26.8, words: "view #3 is seen as no view" });
  assert.deepEqual([button, title], ["view 0:26.8", "Since tick 268: view #3 is seen as no view. Show that moment."]);
  const estimate = { x: 0, y: 0, heading_rad: 0 };
  const beside = { first: brain, second: brain, since_s: 0, estimate, differences: [], changed: [] };
  assert.equal(odometryWords({ ...beside, error_odometry_m: null }), "");
  assert.equal(odometryWords({ ...beside, error_odometry_m: 1.5 }), "Odometry alone: 1.50 m");
});

test("what makes the difference is told, from the first brain to the second, and not without end", () => {
  const told = changedWords([{ name: "local_view.enabled", first: true, second: false }]);
  assert.deepEqual(told, { button: "1 parameter", title: "local_view.enabled: on → off" });
  const many = changedWords(Array.from({ length: 9 }, (_, k) => ({ name: `a.b${k}`, first: 0.1 + 0.2, second: "x" })));
  assert.equal(many.button, "9 parameters");
  assert.match(many.title, /^a\.b0: 0\.3 → x\n(.*\n)*and 3 more$/);
});

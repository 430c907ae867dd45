// Sentences made of what the server says.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  ended,
  experiences,
  freeName,
  keptWords,
  megabytes,
  plainly,
  sentence,
} from "../../../web/static/model/sentences.js";

test("a sentence begins with a capital letter and has one full stop", () => {
  assert.deepEqual(["x is wrong", "Why?", "so."].map(sentence), ["X is wrong.", "Why?", "So."]);
  assert.deepEqual(["plan.png: too large", "Stop!"].map(ended), ["plan.png: too large.", "Stop!"]);
});

test("a refusal is told without the number that a thing has in a file", () => {
  assert.equal(
    plainly("steps[2]: walls[17] (north wall) would cover the robot"),
    "the north wall would cover the robot",
  );
  assert.equal(plainly("walls[17] (north wall) is too long"), "walls[17] (north wall) is too long");
  assert.equal(plainly("the office is another edition"), "the office is another edition");
});

test("counts and sizes", () => {
  assert.deepEqual([0, 1, 2345].map(experiences), ["0 experiences", "1 experience", "2,345 experiences"]);
  assert.equal(megabytes(16_040_000), "16.0 MB");
});

test("a new world has the first name that nobody has", () => {
  assert.equal(freeName({ yours: {}, ours: { office: "Office" } }), "my-world");
  assert.equal(freeName({ yours: { "my-world": "", "my-world-3": "" }, ours: { "my-world-2": "" } }), "my-world-4");
});

test("what was kept today is told by the hour, what is older by the day too", () => {
  const kept = { world: "office", title: "Office", experiences: 1, time_s: 600, kept_at: 1_700_000_000, run: null };
  assert.match(keptWords(kept, kept.kept_at + 60), /^Office, 10 simulated minutes, 1 experience, kept \d\d:\d\d$/);
  assert.match(keptWords(kept, kept.kept_at + 13 * 3600), /kept 1[45] Nov 2023, \d\d:\d\d$/);
});

// What is read aloud.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Speech } from "../../../web/static/model/speech.js";

test("what matters is said once, by its name", () => {
  const speech = new Speech();
  speech.hear(
    [
      { kind: "parameter", text: "a = 3" },
      { kind: "kidnap", text: "moved by 4.0 m" },
      { kind: "arrived", text: "at experience 12" },
    ],
    0,
  );
  assert.equal(speech.next(), "kidnap: moved by 4.0 m. arrived: at experience 12.");
  assert.equal(speech.next(), "");
});

test("of too many the weightiest are said, in their order", () => {
  const speech = new Speech();
  const tags = Array.from({ length: 5 }, (_, k) => ({ kind: "tagged", text: `tag ${k}` }));
  speech.hear([{ kind: "kidnap", text: "a" }, ...tags, { kind: "fault", text: "b" }, { kind: "goal", text: "c" }], 0);
  assert.equal(speech.next(), "kidnap: a. fault: b. goal set: c. And 5 more events.");
});

test("what comes in swarms is told now and then, and what a lesson says always", () => {
  const speech = new Speech();
  const snap = { kind: "snap", text: "the winner snaps by 4 cells" };
  speech.hear([snap, snap, snap], 100);
  assert.equal(speech.next(), "snap: the winner snaps by 4 cells.");
  speech.hear([snap, { kind: "lesson", text: "Kidnapped: it happens" }, { kind: "lesson", text: "it is over" }], 107);
  assert.equal(speech.next(), "lesson: Kidnapped: it happens. lesson: it is over.");
  speech.hear([snap], 116);
  assert.match(speech.next(), /snap/);
});

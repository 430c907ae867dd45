// What the page says: sentences of the server's words, what is read aloud, where places are, what a newcomer has done.

import assert from "node:assert/strict";
import { test } from "node:test";
import { FirstMinute } from "../../../web/static/header/help.js";
import { choices, Speech, whereabouts } from "../../../web/static/ui/access.js";
import * as said from "../../../web/static/ui/words.js";
import { plainly } from "../../../web/static/editor/world_client.js";
import { freeName } from "../../../web/static/worlds/own_worlds.js";
import { experiences, keptWords } from "../../../web/static/worlds/kept_brain.js";

test("a sentence begins with a capital letter and has one full stop; counts and sizes are in words", () => {
  assert.deepEqual(["x is wrong", "Why?", "so."].map(said.sentence), ["X is wrong.", "Why?", "So."]);
  assert.deepEqual(["plan.png: too large", "Stop!"].map(said.ended), ["plan.png: too large.", "Stop!"]);
  assert.deepEqual([0, 1, 2345].map(experiences), ["0 experiences", "1 experience", "2,345 experiences"]);
  assert.equal(said.megabytes(16_040_000), "16.0 MB");
});

test("evidence is told in times, which a place becomes likelier", () => {
  assert.equal(said.likelier(Math.log(1234)), "1,200 times likelier");
  assert.equal(said.likelier(-Math.log(2.5)), "2.5 times less likely");
  assert.equal(said.likelier(0.01), "as likely as before");
  assert.equal(said.likelier(20), "over a million times likelier");
});

test("a refusal is told without the number that a thing has in a file", () => {
  for (const [told, plain] of [
    ["steps[2]: walls[17] (north wall) would cover the robot", "the north wall would cover the robot"],
    ["walls[17] (north wall) is too long", "walls[17] (north wall) is too long"],
    ["the office is another edition", "the office is another edition"],
  ])
    assert.equal(plainly(told), plain);
});

test("a new world has the first name that nobody has", () => {
  assert.equal(freeName({ yours: {}, ours: { office: "Office" } }), "my-world");
  const yours = { "my-world": "", "my-world-3": "" };
  assert.equal(freeName({ yours, ours: { "my-world-2": "" } }), "my-world-4");
});

test("what was kept today is told by the hour, what is older by the day too", () => {
  const kept = { world: "office", title: "Office", experiences: 1, time_s: 600, kept_at: 1_700_000_000, run: null };
  const words = (/** @type {number} */ hours) => keptWords(kept, kept.kept_at + 3600 * hours);
  assert.match(words(0.1), /^Office, 10 simulated minutes, 1 experience, kept \d\d:\d\d$/);
  assert.match(words(13), /kept 1[45] Nov 2023, \d\d:\d\d$/);
});

const event = (/** @type {string} */ kind, text = "") => /** @type {TimelineEvent} */ ({ kind, text, number: 7 });

test("what matters is read aloud once, by its name; of too much the weightiest, in its order", () => {
  const speech = new Speech();
  speech.onEvents(
    [event("parameter", "a = 3"), event("kidnap", "moved by 4.0 m"), event("arrived", "at experience 12")],
    0,
  );
  assert.equal(speech.next(), "kidnap: moved by 4.0 m. arrived: at experience 12.");
  assert.equal(speech.next(), "");
  const tags = Array.from({ length: 5 }, (_, k) => event("tagged", `tag ${k}`));
  speech.onEvents([event("kidnap", "a"), ...tags, event("fault", "b"), event("goal", "c")], 0);
  assert.equal(speech.next(), "kidnap: a. fault: b. goal set: c. And 5 more events.");
});

test("what comes in swarms is told now and then, and what a lesson says always", () => {
  const [speech, snap] = [new Speech(), event("snap", "the winner snaps by 4 cells")];
  speech.onEvents([snap, snap, snap], 100);
  assert.equal(speech.next(), "snap: the winner snaps by 4 cells.");
  speech.onEvents([snap, event("lesson", "Kidnapped: it happens"), event("lesson", "it is over")], 107);
  assert.equal(speech.next(), "lesson: Kidnapped: it happens. lesson: it is over.");
  speech.onEvents([snap], 116);
  assert.match(speech.next(), /snap/);
});

test("each of a newcomer's three things is done when it has happened, in any order", () => {
  const first = new FirstMinute();
  first.at(FirstMinute.TICKS - 1);
  first.onEvents([event("recovered"), event("goal")]);
  assert.deepEqual([first.explored, first.reached, first.found], [false, false, false]);
  assert.deepEqual([first.after, first.why], ["", null]);
  const believes = event("believes", "a place");
  first.onEvents([event("kidnap"), event("lost"), believes, event("recovered", "right again after 2 s")]);
  assert.ok(first.found);
  assert.deepEqual([first.after, first.why], ["right again after 2 s", believes.number]);
  first.at(FirstMinute.TICKS);
  assert.ok(!first.done);
  first.onEvents([event("arrived")]);
  assert.ok(first.done);
});

const robot = { x: 1, y: 1, heading_rad: Math.PI / 2 };
const places = {
  robot,
  to_goal: false,
  tags: [{ name: "the printer", experience: 7, x: 4, y: 1 }],
  named: [
    {
      name: "kitchen",
      experience: null,
      x: null,
      y: null,
      why: "it has not been near it yet: explores until it comes there",
    },
    { name: "library", experience: 3, x: 5, y: 1, why: null },
  ],
  experiences: [
    { id: 3, x: 5, y: 1, seconds: null },
    { id: 7, x: 4, y: 1, seconds: 12.4 },
  ],
};

test("a place is where the robot would point to", () => {
  for (const [x, y, words] of /** @type {[number, number, string][]} */ ([
    [1, 4, "3.0 m ahead"],
    [-1, 1, "2.0 m to the left"],
    [13, 1, "12 m to the right"],
    [2, 0, "1.4 m behind to the right"],
    [1.1, 1, "here"],
  ]))
    assert.equal(whereabouts(robot, { x, y }), words);
});

test("named places come first, then the nearest experiences; what is typed is sought in the names", () => {
  const listed = (/** @type {string} */ typed, most = 9) =>
    choices(places, typed, most).map(({ title, where }) => `${title}: ${where}`);
  const all = [
    "the printer: 3.0 m to the right",
    "library: 4.0 m to the right",
    "kitchen: it has not been near it yet: explores until it comes there",
    "Experience 7: 3.0 m to the right, 12 s",
    "Experience 3: 4.0 m to the right, no route known",
  ];
  assert.deepEqual(listed(""), all);
  assert.deepEqual(listed("", 2), all.slice(0, 2));
  assert.deepEqual(listed(" PRINT"), all.slice(0, 1));
  assert.deepEqual(listed("ence 3"), all.slice(4));
});

test("while nothing is typed, a few experiences stand for those around them", () => {
  const experiences = Array.from({ length: 50 }, (_, id) => ({ id, x: 1 + 0.1 * id, y: 1, seconds: id }));
  const shown = (/** @type {string} */ typed) =>
    choices({ robot, to_goal: false, tags: [], named: [], experiences }, typed, 99).map(({ experience }) => experience);
  assert.deepEqual(shown(""), [10, 20, 30, 40]);
  assert.equal(shown("Experience").length, 50);
});

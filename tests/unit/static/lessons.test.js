// Chapters, states and words of lessons.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as lessons from "../../../web/static/model/lessons.js";
import { CHOICES, ending } from "../../../web/static/model/until.js";
import { voteWords } from "../../../web/static/model/vote.js";

/** @param {string} name @param {Partial<LessonCard>} [other] @returns {LessonCard} */
const card = (name, other = {}) => ({
  name,
  number: 1,
  title: name,
  idea: "",
  paper: "A 4",
  minutes: 0.2,
  rounds: 1,
  own: false,
  wrong: null,
  ...other,
});

/** @param {Partial<LessonView>} other @returns {LessonView} */
const view = (other = {}) => ({
  name: "packet",
  title: "",
  state: "predict",
  doing: "",
  progress: null,
  round: 1,
  rounds: 1,
  label: "",
  seed: 1,
  prediction: null,
  votes: { counts: [0, 0], points: [] },
  outcome: null,
  marks: [],
  altered: false,
  draws: null,
  ...other,
});

/** @type {NonNullable<LessonView["outcome"]>} */
const outcome = { words: "it turned", because: "", right: null, choice: 1, x: null, y: null, distance_m: null };
/** @type {LessonMark} */
const ENDED = { plate: "office", x: 0, y: 0, heading_rad: null, words: "it ended here", tick: 9 };
/** @type {LessonText["predict"]} */
const asked = { question: "?", options: ["left", "right"], draw: null, plate: "map" };

test("every lesson is in one chapter, in the order of all, the user's own last", () => {
  const cards = ["packet", "dark", "loop", "unheard-of", "goal"].map((name) => card(name));
  const all = lessons.chapters([card("mine", { own: true }), ...cards]);
  assert.deepEqual(
    all.flatMap((chapter) => chapter.cards.map(({ name }) => name)),
    ["packet", "dark", "loop", "unheard-of", "goal", "mine"],
  );
  assert.deepEqual(
    all.map((chapter) => chapter.cards.length),
    [2, 2, 1, 1],
  );
  assert.equal(lessons.chapters([card("unheard-of")]).length, 1);
  assert.deepEqual(lessons.chapters([]), []);
});

test("the next lesson is the next one that can be begun", () => {
  const cards = [card("a"), card("b", { wrong: "no such world" }), card("c")];
  assert.equal(lessons.nextAfter(cards, "a")?.name, "c");
  assert.equal(lessons.nextAfter(cards, "c"), null);
  assert.equal(lessons.nextAfter(cards, "gone"), null);
});

test("a lesson says how long it is, and its number", () => {
  assert.equal(lessons.cardFacts(card("a")), "A 4 · 10 s");
  assert.equal(lessons.cardFacts(card("a", { minutes: 14.6, rounds: 3 })), "A 4 · 15 min · 3 rounds");
  assert.equal(lessons.which(view(), card("a", { number: 7 })), "Lesson 7 · A 4");
  assert.equal(lessons.which(view({ rounds: 3, round: 2 }), card("a")), "Lesson 1 · A 4 · round 2 of 3");
  assert.equal(lessons.which(view(), card("a", { own: true })), "A 4");
});

test("predictions are taken before the first round is shown", () => {
  assert.ok(lessons.isOpen(view()));
  assert.ok(lessons.isOpen(view({ state: "scene" })));
  assert.ok(!lessons.isOpen(view({ state: "showing" })));
  assert.ok(!lessons.isOpen(view({ state: "scene", round: 2, rounds: 2 })));
  assert.ok(!lessons.isOpen(view({ rounds: 2, marks: [ENDED] })));
});

test("without a prediction it is only shown; while the scene is set it cannot be", () => {
  assert.equal(lessons.showWords(view()), "Just show me");
  assert.equal(lessons.showWords(view({ votes: { counts: [0, 1], points: [] } })), "Let it happen");
  assert.equal(lessons.showWords(view({ prediction: { choice: 0, x: null, y: null } })), "Let it happen");
  assert.equal(lessons.showWords(view({ rounds: 3, marks: [ENDED] })), "Show the next round");
  assert.equal(lessons.showWords(view({ state: "scene" })), null);
  assert.equal(lessons.showWords(view({ state: "compared" })), null);
});

test("what is going on is said as a sentence, and so is what is to be done", () => {
  assert.equal(lessons.doingWords(view({ state: "showing", doing: "drives on" })), "Drives on.");
  assert.match(lessons.doingWords(view()), /First say/);
  assert.equal(lessons.doingWords(view({ prediction: { choice: 0, x: null, y: null } })), "");
  assert.equal(lessons.doingWords(view({ rounds: 2, marks: [ENDED], doing: "3 deg/s is next" })), "3 deg/s is next.");
  assert.match(lessons.doingWords(view({ state: "sandbox", altered: true })), /yours/);
});

test("a lesson that was broken off says by what; one that came to its end does not", () => {
  const doing = "broken off: somebody drove the robot by hand";
  const broken = view({ state: "sandbox", doing, altered: true });
  assert.ok(lessons.isBroken(broken));
  assert.equal(
    lessons.doingWords(broken),
    'Broken off: somebody drove the robot by hand. "Once more" begins it again.',
  );
  const over = view({ state: "sandbox", doing: "play freely", outcome });
  assert.ok(!lessons.isBroken(over));
  assert.equal(lessons.doingWords(over), "");
});

test("what to watch stays where Inspect tells why", () => {
  const text = /** @type {LessonText} */ ({ explains: false });
  const explained = { ...text, explains: true };
  assert.ok(lessons.isWatched(view({ state: "showing" }), text));
  assert.ok(lessons.isWatched(view({ rounds: 2, marks: [ENDED] }), text));
  assert.ok(!lessons.isWatched(view({ state: "compared", outcome }), text));
  assert.ok(lessons.isWatched(view({ state: "compared", outcome }), explained));
  assert.ok(!lessons.isWatched(view(), explained));
});

test("votes are shares of all, and are held against what came true", () => {
  assert.deepEqual(lessons.shares([3, 1, 0]), [0.75, 0.25, 0]);
  assert.deepEqual(lessons.shares([0, 0]), [0, 0]);
  assert.equal(lessons.classWords(view()), "");
  const votes = { counts: [3, 1], points: [] };
  assert.equal(lessons.classWords(view({ votes })), "4 votes");
  assert.equal(lessons.classWords(view({ votes, outcome })), "1 of 4 votes were for it");
  assert.equal(lessons.classWords(view({ votes: { counts: [], points: [[1, 2]] } })), "1 vote");
});

test("prediction and outcome are compared", () => {
  assert.equal(lessons.verdict(view({ outcome }), asked).tone, "none");
  const prediction = { choice: 0, x: null, y: null };
  const wrong = lessons.verdict(view({ prediction, outcome: { ...outcome, right: false } }), asked);
  assert.deepEqual([wrong.tone, wrong.said], ["wrong", "left"]);
  const right = lessons.verdict(view({ prediction, outcome: { ...outcome, right: true, choice: 0 } }), asked);
  assert.deepEqual([right.tone, right.said], ["right", "left"]);
  const drawn = { ...outcome, choice: null, x: 1, y: 1, distance_m: 2.34, right: false };
  const point = lessons.verdict(view({ prediction: { choice: null, x: 2, y: 2 }, outcome: drawn }), asked);
  assert.equal(point.said, "2.3 m from where it ended");
});

test("a moment that is marked on both plates is listed once, in the order of time", () => {
  const at = { x: 0, y: 0, heading_rad: null };
  /** @type {LessonMark[]} */
  const marks = [
    { plate: "office", words: "lost", tick: 650, ...at },
    { plate: "map", words: "lost", tick: 650, ...at },
    { plate: "office", words: "put down", tick: 600, ...at },
  ];
  assert.deepEqual(
    lessons.moments(marks, (tick) => tick / 10).map(({ words, at }) => [words, at]),
    [
      ["put down", "1:00"],
      ["lost", "1:05"],
    ],
  );
});

test("an address names a lesson, and nothing else", () => {
  assert.equal(lessons.linked("#lesson=two-doors"), "two-doors");
  for (const other of ["", "#run=3", "#lesson=", "#lesson=A/B", "#lesson=a&b"])
    assert.equal(lessons.linked(other), null);
});

test("what is looked at has a name", () => {
  assert.equal(lessons.tabOf("truth", ["Senses", "Truth"]), "Truth");
  assert.equal(lessons.tabOf("pose", ["Senses", "Truth"]), null);
  assert.equal(lessons.placeWords("pose"), "Pose cells");
  assert.equal(lessons.placeWords("memory"), "Memory");
});

test("a plan has room around its walls", () => {
  const { left, bottom, width, height } = lessons.outline([
    [
      [0, 0],
      [10, 0],
    ],
    [
      [10, 0],
      [10, 5],
    ],
  ]);
  assert.ok(left < 0 && bottom < 0 && left + width > 10 && bottom + height > 5);
  assert.ok(Number.isFinite(lessons.outline([]).width));
});

test("a map is turned as on its plate, and back", () => {
  const [x, y] = lessons.turned([2, 1], Math.PI / 2);
  assert.ok(Math.abs(x + 1) < 1e-9 && Math.abs(y - 2) < 1e-9);
  const there = lessons.turned(lessons.turned([3, -4], 0.7), -0.7);
  assert.ok(Math.hypot(there[0] - 3, there[1] + 4) < 1e-9);
});

test("only what has happened is told as such", () => {
  assert.ok(CHOICES.length >= 5);
  assert.match(ending({ what: "lost", words: "it is lost", state: "met", progress: 1 }) ?? "", /it is lost/);
  for (const state of /** @type {const} */ (["running", "too late", "broken off"]))
    assert.equal(ending({ what: "lost", words: "", state, progress: 0.5 }), null);
});

test("a voter is told whether the vote counts, and what came true", () => {
  assert.match(voteWords(null, false, asked), /Waiting/);
  assert.match(voteWords(view(), true, asked), /counts/);
  assert.match(voteWords(view({ state: "showing" }), true, asked), /screen/);
  assert.match(voteWords(view({ state: "compared", outcome }), true, asked), /right.*it turned/);
});

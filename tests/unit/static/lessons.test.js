// Chapters, states and words of lessons.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as lessons from "../../../web/static/lessons/question.js";
import { outline, turned, voteWords } from "../../../web/static/lessons/question.js";
import { cardFacts, chapters, linked, nextAfter } from "../../../web/static/lessons/list.js";
import { CHOICES, ending } from "../../../web/static/timeline/tools.js";
import { segment } from "./made.js";

/** @param {string} name @param {Partial<LessonCard>} [other] @returns {LessonCard} */
const card = (name, other = {}) => ({
  ...{ name, number: 1, title: name, idea: "", paper: "A 4", minutes: 0.2, rounds: 1, own: false, wrong: null },
  ...other,
});

/** @param {Partial<LessonView>} other @returns {LessonView} */
const view = (other = {}) => ({
  ...{
    name: "packet",
    title: "",
    state: "predict",
    doing: "",
    progress: null,
    round: 1,
    rounds: 1,
    label: "",
    seed: 1,
  },
  ...{
    prediction: null,
    votes: { counts: [0, 0], points: [] },
    outcome: null,
    marks: [],
    altered: false,
    draws: null,
  },
  ...other,
});

/** @type {NonNullable<LessonView["outcome"]>} */
const outcome = { words: "it turned", because: "", right: null, choice: 1, x: null, y: null, distance_m: null };
/** @type {LessonMark} */
const ENDED = { plate: "office", x: 0, y: 0, heading_rad: null, words: "it ended here", tick: 9 };
/** @type {LessonText["predict"]} */
const asked = { question: "?", options: ["left", "right"], draw: null, plate: "map" };
const chosen = { choice: 0, x: null, y: null };
const votes = { counts: [3, 1], points: [] };

test("every lesson is in one chapter, in the order of all, the user's own last", () => {
  const cards = ["packet", "dark", "loop", "unheard-of", "goal"].map((name) => card(name));
  const all = chapters([card("mine", { own: true }), ...cards]);
  const names = all.map((chapter) => chapter.cards.map(({ name }) => name).join());
  assert.deepEqual(names, ["packet,dark", "loop,unheard-of", "goal", "mine"]);
  assert.equal(chapters([card("unheard-of")]).length, 1);
  assert.deepEqual(chapters([]), []);
});

test("the next lesson is the next one that can be begun", () => {
  const cards = [card("a"), card("b", { wrong: "no such world" }), card("c")];
  const next = ["a", "c", "gone"].map((name) => nextAfter(cards, name)?.name);
  assert.deepEqual(next, ["c", undefined, undefined]);
});

test("a lesson says how long it is, and its number", () => {
  assert.equal(cardFacts(card("a")), "ACRA 2004 4 · 10 s");
  assert.equal(cardFacts(card("a", { minutes: 14.6, rounds: 3 })), "ACRA 2004 4 · 15 min · 3 rounds");
  assert.equal(lessons.which(view(), card("a", { number: 7 })), "Lesson 7");
  assert.equal(lessons.which(view({ rounds: 3, round: 2 }), card("a")), "Lesson 1 · round 2 of 3");
  assert.equal(lessons.which(view(), card("a", { own: true })), "Lesson");
});

test("predictions are taken before the first round is shown", () => {
  assert.ok([view(), view({ state: "scene" })].every(lessons.isOpen));
  /** @type {Partial<LessonView>[]} */
  const later = [{ state: "showing" }, { state: "scene", round: 2, rounds: 2 }, { rounds: 2, marks: [ENDED] }];
  assert.ok(!later.map(view).some(lessons.isOpen));
});

test("without a prediction it is only shown; while the scene is set it cannot be", () => {
  for (const [state, words] of /** @type {[Partial<LessonView>, string | null][]} */ ([
    [{}, "Just show me"],
    [{ votes: { counts: [0, 1], points: [] } }, "Let it happen"],
    [{ prediction: chosen }, "Let it happen"],
    [{ rounds: 3, marks: [ENDED] }, "Show the next round"],
    [{ state: "scene" }, null],
    [{ state: "compared" }, null],
  ]))
    assert.equal(lessons.showWords(view(state)), words);
});

test("what is going on is said as a sentence", () => {
  const doing = "broken off: somebody drove the robot by hand";
  for (const [state, words] of /** @type {[Partial<LessonView>, RegExp][]} */ ([
    [{ state: "showing", doing: "drives on" }, /^Drives on\.$/],
    [{}, /^$/],
    [{ rounds: 2, marks: [ENDED], doing: "3 deg/s is next" }, /^3 deg\/s is next\.$/],
    [{ state: "sandbox", altered: true }, /Changed/],
    [{ state: "sandbox", altered: true, doing }, /^Broken off: somebody drove the robot by hand\.$/],
    [{ state: "sandbox", doing: "play freely", outcome }, /^$/],
  ]))
    assert.match(lessons.doingWords(view(state)), words);
  assert.ok(lessons.isBroken(view({ state: "sandbox", doing, altered: true })));
  assert.ok(!lessons.isBroken(view({ state: "sandbox", doing: "play freely", outcome })));
});

test("each state has in sight what it is about; a plan also what is compared on it", () => {
  for (const [state, words] of /** @type {[Partial<LessonView>, string][]} */ ([
    [{ state: "scene" }, "question, plan"],
    [{}, "question, plan"],
    [{ state: "showing" }, "watch"],
    [{ rounds: 2, marks: [ENDED] }, "watch"],
    [{ state: "compared", outcome }, "outcome"],
    [{ state: "compared", outcome, draws: "map" }, "outcome, plan"],
    [{ state: "sandbox", outcome, draws: "map" }, "sandbox"],
  ])) {
    const now = view(state);
    const parts = { watch: lessons.isWatched(now), ...lessons.unfolded(now), plan: lessons.isPlanShown(now) };
    const seen = Object.entries(parts).flatMap(([part, is]) => (is ? [part] : []));
    assert.equal(seen.join(", "), words);
  }
});

test("what is told before a question is no part of it", () => {
  for (const [text, setting, question] of [
    ["It is 3.6 m away. How will it go?", "It is 3.6 m away.", "How will it go?"],
    ["It drives on. Where will it be? Draw a point.", "It drives on.", "Where will it be? Draw a point."],
    ["What now?", "", "What now?"],
    ["Draw a point.", "", "Draw a point."],
  ])
    assert.deepEqual(lessons.inTwo(text), [setting, question]);
});

test("votes are shares of all, and are held against what came true", () => {
  assert.deepEqual(lessons.shares([3, 1, 0]), [0.75, 0.25, 0]);
  assert.deepEqual(lessons.shares([0, 0]), [0, 0]);
  /** @type {Partial<LessonView>[]} */
  const states = [{}, { votes }, { votes, outcome }, { votes: { counts: [], points: [[1, 2]] } }];
  assert.deepEqual(
    states.map((state) => lessons.classWords(view(state))),
    ["", "4 votes", "1 of 4 predicted it", "1 vote"],
  );
});

test("prediction and outcome are compared", () => {
  const verdict = (/** @type {Partial<LessonView>} */ state) => {
    const { tone, said } = lessons.verdict(view(state), asked);
    return [tone, said];
  };
  assert.equal(verdict({ outcome })[0], "none");
  assert.deepEqual(verdict({ prediction: chosen, outcome: { ...outcome, right: false } }), ["wrong", "left"]);
  assert.deepEqual(verdict({ prediction: chosen, outcome: { ...outcome, right: true, choice: 0 } }), ["right", "left"]);
  const drawn = { ...outcome, choice: null, x: 1, y: 1, distance_m: 2.34, right: false };
  const [, said] = verdict({ prediction: { choice: null, x: 2, y: 2 }, outcome: drawn });
  assert.equal(said, "2.3 m from where it ended");
});

test("a moment that is marked on both plates is listed once, in the order of time", () => {
  const at = { x: 0, y: 0, heading_rad: null };
  /** @type {LessonMark[]} */
  const marks = [
    { plate: "office", words: "lost", tick: 650, ...at },
    { plate: "map", words: "lost", tick: 650, ...at },
    { plate: "office", words: "put down", tick: 600, ...at },
  ];
  const told = lessons.moments(marks, (tick) => tick / 10).map(({ words, at }) => `${at} ${words}`);
  assert.deepEqual(told, ["1:00 put down", "1:05 lost"]);
});

test("an address names a lesson, and nothing else; what is looked at has a name", () => {
  assert.equal(linked("#lesson=two-doors"), "two-doors");
  for (const other of ["", "#run=3", "#lesson=", "#lesson=A/B", "#lesson=a&b"]) assert.equal(linked(other), null);
  assert.deepEqual(
    ["truth", "pose"].map((place) => lessons.tabOf(place, ["Senses", "Truth"])),
    ["Truth", null],
  );
  assert.deepEqual(["pose", "memory"].map(lessons.placeWords), ["Pose cells", "Memory"]);
});

test("a plan has room around its walls; a map is turned as on its plate, and back", () => {
  const { left, bottom, width, height } = outline([segment("0 0, 10 0"), segment("10 0, 10 5")]);
  assert.ok(left < 0 && bottom < 0 && left + width > 10 && bottom + height > 5);
  assert.ok(Number.isFinite(outline([]).width));
  const [x, y] = turned([2, 1], Math.PI / 2);
  assert.ok(Math.abs(x + 1) < 1e-9 && Math.abs(y - 2) < 1e-9);
  const there = turned(turned([3, -4], 0.7), -0.7);
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

// The words and the order of the experiments' gallery.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as gallery from "../../../web/static/experiments/grid.js";
import { facts, lengthWords, matches, trialWords } from "../../../web/static/experiments/gallery.js";

/** @type {Dot} */
const dot = { id: "a", seed: 7, quick: false, good: 2, of: 3, words: "2 of 3", moment_s: 65, moment: "printer: late" };
/** @param {Axis[]} axes @returns {Card} */
const card = (axes) => ({
  ...{ name: "x", title: "X", paper: "D", asks: "?", found: ".", world: "Office", engines: ["paper", "ours"], axes },
  ...{ watch: [], seed: 1, trials: 10, seconds: 1320, done: 0, picture: null, plan: null },
});
/** @param {string[]} levels @returns {Cell} */
const cell = (...levels) => ({ engine: "ours", levels, n: 0, words: "", shade: null, dots: [] });
/** @param {string} name @param {string[]} levels */
const axis = (name, ...levels) => ({ name, levels });
/** @type {Trial} */
const trial = {
  ...{ experiment: "table", title: "T", engine: "paper", levels: ["2 %"], seed: 7, id: "a", state: "running" },
  ...{ doing: "exploring", about_s: 1500, ahead: null, altered: false, outcome: "" },
};

test("a length is in round words, and a card's facts leave out what there is none of", () => {
  assert.deepEqual([2, 24, 61, 1320, 9000].map(lengthWords), ["5 s", "25 s", "60 s", "22 min", "2.5 h"]);
  assert.equal(facts(card([])), "22 min a trial");
  const full = { ...card([axis("a", "1", "2"), axis("b", "3", "4", "5")]), done: 1 };
  assert.equal(facts(full), "22 min a trial · 6 settings · 1 trial run here");
  assert.equal(gallery.firstEngine(full), "ours");
  assert.equal(gallery.firstEngine({ ...full, engines: ["paper"] }), "paper");
});

test("a card is found by its words, its paper and each figure of a range, whole numbers only", () => {
  const one = { ...card([]), title: "Size of the pose cells", paper: "D 5-6, table 1, figures 6 to 15" };
  for (const wanted of ["", "figure 9", "Fig 15", "acra 2006", "pose office", "table 1", "size"])
    assert.ok(matches(one, wanted), wanted);
  for (const wanted of ["figure 16", "figure 1.5", "2005", "kidnap"]) assert.ok(!matches(one, wanted), wanted);
});

test("the first axis goes across and the second down; of the others one level is shown", () => {
  const axes = [axis("a", "1", "2"), axis("b", "x", "y"), axis("c", "p", "q")];
  const cells = axes[0].levels.flatMap((a) => axes[1].levels.flatMap((b) => axes[2].levels.map((c) => cell(a, b, c))));
  const results = { score: "s", is_rate: true, note: "", cells };
  const rows = gallery.rowsOf(card(axes), results, "ours", ["q"]);
  const told = rows.map(({ label, cells }) => `${label}: ${cells.map((one) => one?.levels.join(""))}`);
  assert.deepEqual(told, ["x: 1xq,2xq", "y: 1yq,2yq"]);
  assert.deepEqual(gallery.rowsOf(card(axes), results, "paper", ["q"])[0].cells, [undefined, undefined]);
  assert.equal(gallery.rowsOf(card([]), { ...results, cells: [cell()] }, "ours", [])[0].cells.length, 1);
});

test("a dot tells by its look, its face and its words how the trial went", () => {
  assert.deepEqual(
    [3, 2, 0, null].map((good) => gallery.lookOf({ ...dot, good })),
    ["all", "some", "none", "plain"],
  );
  assert.deepEqual(
    [3, 2, 0, null].map((good) => gallery.fellShort({ ...dot, good })),
    [false, true, true, false],
  );
  assert.equal(gallery.dotFace(dot), "2/3");
  assert.equal(gallery.dotFace({ ...dot, good: null, of: null, words: "0.12 m" }), "0.12 m");
  const results = { score: "goals reached", is_rate: true, note: "", cells: [] };
  assert.equal(
    gallery.dotWords(dot, results),
    "Seed 7: 2 of 3 goals reached. Decided at 1:05: printer: late. Plays from 0:55.",
  );
  assert.match(gallery.dotWords({ ...dot, moment_s: 4 }, results), /Plays from 0:00/);
  assert.deepEqual(
    [gallery.settingWords(cell("2 %", "8 x 8")), gallery.settingWords(cell())],
    ["2 %, 8 x 8", "as it is"],
  );
});

test("the note on the stage says what is being done, how far it is, and what came of it", () => {
  const now = trialWords(trial, 200);
  assert.deepEqual([now.which, now.settings], ["T", "the paper's rules · 2 % · seed 7"]);
  assert.deepEqual([now.doing, now.clock, now.share], ["exploring", "3:20 of about 25:00", 200 / 1500]);
  assert.equal(trialWords({ ...trial, altered: true }, 1).doing, "exploring, changed by hand");
  const ahead = trialWords({ ...trial, ahead: 0.439 }, 200);
  assert.deepEqual([ahead.doing, ahead.clock], ["going to the moment that decided it", "43 %"]);
  const over = trialWords({ ...trial, state: "over", outcome: "3 of 3 goals reached" }, 1600);
  assert.deepEqual([over.doing, over.share], ["over: 3 of 3 goals reached", 1]);
  const ended = trialWords({ ...trial, state: "ended", outcome: "somebody drove the robot by hand" }, 90);
  assert.deepEqual([ended.doing, ended.share], ["ended: somebody drove the robot by hand", null]);
});

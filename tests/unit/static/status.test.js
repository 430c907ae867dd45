// The words of the header.

import assert from "node:assert/strict";
import { test } from "node:test";
import { duration, goalWords, statusOf } from "../../../web/static/model/status.js";
import { GOAL_STATES } from "../../../web/static/shared.js";

/** @type {Goal} */
const goal = { experience: 7, x: 1, y: 2, state: "tracking", eta_s: 61.4, remaining_m: 12.34 };
const packet = { x: 0, y: 0, heading_rad: 0, mass: 1 };
/** @type {Parameters<typeof statusOf>[0]} */
const state = { running: true, mode: "explore", goal: null, pose_cells: { shape: [], packets: [packet] } };
const page = { fault: null, lost: false };

test("what counts most is said: a fault, then a pause, being lost, the hand, the goal", () => {
  const lost = { ...page, lost: true };
  const words = (/** @type {Partial<typeof state>} */ change, now = page) => statusOf({ ...state, ...change }, now)[2];
  assert.equal(words({ running: false }, { ...lost, fault: /** @type {any} */ ("broken") }), "stopped by a fault");
  assert.equal(words({}, { ...lost, fault: /** @type {any} */ ("slow") }), "in a long tick");
  assert.equal(words({ running: false }, lost), "paused");
  assert.equal(words({ mode: "manual" }, lost), "lost");
  assert.equal(words({ pose_cells: { shape: [], packets: [packet, packet] } }, lost), "lost: 2 packets");
  assert.equal(words({ mode: "manual", goal }), "driving by hand");
  assert.equal(words({ mode: "goal", goal }), "going to the goal");
  assert.equal(words({ mode: "goal" }), "exploring");
  assert.equal(words({ goal }), "exploring");
  const look = { plate: /** @type {const} */ ("all"), tab: null, camera: null };
  const situation = { state: /** @type {const} */ ("playing"), tick: 1, end_tick: 2, words: "", state_hash: "", look };
  assert.equal(statusOf({ ...state, running: false }, { ...page, situation })[2], "playing up to a moment");
});

test("a recording plays until it has ended", () => {
  const recording = { name: "walk", format: "MCAP", moments: 3, seconds: 0.2, has: ["camera"], over: false };
  const words = (/** @type {boolean} */ running, /** @type {boolean} */ over) =>
    statusOf({ ...state, running, mode: "recorded" }, { ...page, recording: { ...recording, over } })[2];
  assert.equal(words(true, false), "playing a recording");
  assert.equal(words(false, false), "paused");
  assert.equal(words(false, true), "the recording has ended");
});

test("each state of a goal has words of its own", () => {
  const titles = GOAL_STATES.map((name) => goalWords({ ...goal, state: name }).title);
  assert.equal(new Set(titles).size, GOAL_STATES.length);
  assert.ok(titles.every((title) => title.endsWith(", experience 7")));
});

test("how far and how long is told while there is a way to go", () => {
  const words = goalWords(goal);
  assert.deepEqual([words.what, words.metres, words.seconds], ["goal", "12.3 m", "61 s"]);
  assert.equal(goalWords({ ...goal, remaining_m: 100 }).metres, "100 m");
  assert.deepEqual(
    [goalWords({ ...goal, eta_s: null }).seconds, goalWords({ ...goal, remaining_m: null }).metres],
    ["", ""],
  );
  for (const [name, what] of /** @type {[GoalState, string][]} */ ([
    ["arrived", "arrived"],
    ["unreachable", "no way"],
  ])) {
    const ended = goalWords({ ...goal, state: name });
    assert.deepEqual([ended.what, ended.metres, ended.seconds], [what, "", ""]);
  }
});

test("long times are told in minutes", () => {
  assert.deepEqual(
    [duration(0.4), duration(119.4), duration(120), duration(3600)],
    ["0 s", "119 s", "2 min", "60 min"],
  );
});

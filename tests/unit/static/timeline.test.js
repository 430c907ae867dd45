// Which events have room on the timeline.

import assert from "node:assert/strict";
import { test } from "node:test";
import { clock, tickTimes } from "../../../web/static/model/clock.js";
import { kinds, markOf, nameOf, weightOf } from "../../../web/static/model/event_kinds.js";
import { labelsOf, marksOf, words } from "../../../web/static/model/timeline.js";
import { EVENT_KINDS } from "../../../web/static/shared.js";
import { chance } from "./chance.js";

/** @param {number} number @param {number} time_s @param {string} kind @returns {TimelineEvent} */
const event = (number, time_s, kind) => ({ number, time_s, kind, text: "x" });
const next = chance(5);
const many = Array.from({ length: 300 }, (_, k) =>
  event(k, k + next(), EVENT_KINDS[Math.floor(next() * EVENT_KINDS.length)]),
);
const x = (/** @type {number} */ time_s) => 6 + 2 * time_s;

test("a clock has hours only when there are some", () => {
  assert.deepEqual(
    [clock(0), clock(59.9), clock(61), clock(3599), clock(3661)],
    ["0:00", "0:59", "1:01", "59:59", "1:01:01"],
  );
});

test("times beneath are round, begin at nought, and are neither few nor many", () => {
  for (const width of [300, 700, 1600])
    for (let end = 60; end < 400_000; end *= 1.13) {
      const times = tickTimes(end, width);
      const step = times[1] - times[0];
      assert.ok(
        times[0] === 0 && times.length >= 2 && times.length <= Math.max(3, width / 110) + 1,
        `${width} ${end}: ${times}`,
      );
      assert.ok(times.every((time, k) => time === k * step && time <= end) && step % 10 === 0);
    }
});

test("all kinds that the engine notes are known, each by a name of its own", () => {
  assert.deepEqual(kinds, [...EVENT_KINDS]);
  assert.equal(new Set(kinds.map(nameOf)).size, kinds.length);
  assert.ok(kinds.every((kind) => /^M/.test(markOf(kind).d)));
  assert.deepEqual([nameOf("never_heard"), weightOf("never_heard"), weightOf("toString")], ["never heard", 1, 1]);
  assert.ok(markOf("never_heard").d);
});

test("no two marks of a kind in five pixels, and those that count most on top", () => {
  const marks = marksOf(many, (time_s) => time_s);
  for (const kind of kinds) {
    const own = marks
      .filter((mark) => mark.kind === kind)
      .map(({ at }) => at)
      .sort((a, b) => a - b);
    assert.ok(own.length > 0);
    assert.ok(
      own.every((at, k) => k === 0 || at - own[k - 1] >= 5),
      kind,
    );
  }
  assert.deepEqual(
    marks.map(({ kind }) => weightOf(kind)),
    marks.map(({ kind }) => weightOf(kind)).sort((a, b) => a - b),
  );
  assert.equal(marksOf(many, (time_s) => 2000 * time_s).length, many.length);
});

test("names are within the timeline and none lies over another; what counts most has its name", () => {
  const labels = labelsOf(many, (time_s) => 6 * (time_s - 200), 620);
  assert.ok(labels.length > 3);
  for (const { at, half } of labels) assert.ok(at - half >= 0 && at + half <= 620);
  for (const [k, one] of labels.entries())
    for (const other of labels.slice(k + 1)) assert.ok(Math.abs(one.at - other.at) >= one.half + other.half);
  const heaviest = Math.max(...many.slice(-60).map(({ kind }) => weightOf(kind)));
  assert.equal(weightOf(labels[0].kind), heaviest);
  assert.deepEqual(labelsOf([event(1, 5, "snap"), event(2, 6, "office")], x, 620), []); // they count too little
  assert.deepEqual(
    labelsOf([event(1, 5, "goal"), event(2, 6, "kidnap")], x, 620).map(({ kind }) => kind),
    ["kidnap"],
  );
});

test("an event is told with its time and its name", () => {
  assert.equal(words({ ...event(1, 61, "unreachable"), text: "to 5" }), "1:01 no way: to 5");
});

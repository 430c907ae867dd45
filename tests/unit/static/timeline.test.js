// Which events have room on the timeline.

import assert from "node:assert/strict";
import { test } from "node:test";
import { clock, fine } from "../../../web/static/ui/words.js";
import { tickTimes, tickTimesIn } from "../../../web/static/timeline/line.js";
import { counted, kinds, markOf, nameOf, weightOf, words } from "../../../web/static/timeline/events.js";
import { frameOf, lying, parted } from "../../../web/static/timeline/comparison.js";
import * as line from "../../../web/static/timeline/line.js";
import { nextEvent } from "../../../web/static/timeline/tools.js";
import { EVENT_KINDS } from "../../../web/static/shared.js";
import { chance, path } from "./made.js";

/** @param {number} number @param {number} time_s @param {string} kind @returns {TimelineEvent} */
const event = (number, time_s, kind) => ({ number, time_s, kind, text: "x", line: "", count: 1, since_s: time_s });
const next = chance(5);
const many = Array.from({ length: 300 }, (_, k) =>
  event(k, k + next(), EVENT_KINDS[Math.floor(next() * EVENT_KINDS.length)]),
);
const x = (/** @type {number} */ time_s) => 6 + 2 * time_s;

test("a clock has hours only when there are some, and a moment is told to the tenth", () => {
  assert.deepEqual([0, 59.9, 61, 3599, 3661].map(clock), ["0:00", "0:59", "1:01", "59:59", "1:01:01"]);
  assert.deepEqual([0, 74, 61.3, 3661.9].map(fine), ["0:00.0", "1:14.0", "1:01.3", "1:01:01.9"]);
});

test("times beneath are round, begin at nought, and are neither few nor many", () => {
  for (const width of [300, 700, 1600])
    for (let end = 60; end < 400_000; end *= 1.13) {
      const times = tickTimes(end, width);
      const step = times[1] - times[0];
      const few = times.length >= 2 && times.length <= Math.max(3, width / 110) + 1;
      assert.ok(times[0] === 0 && few, `${width} ${end}: ${times}`);
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
  const marks = line.marksOf(many, (time_s) => time_s);
  for (const kind of kinds) {
    const own = marks.filter((mark) => mark.kind === kind).map(({ at }) => at);
    own.sort((a, b) => a - b);
    assert.ok(own.length > 0 && own.every((at, k) => k === 0 || at - own[k - 1] >= 5), kind);
  }
  const weights = marks.map(({ kind }) => weightOf(kind));
  assert.deepEqual(
    weights,
    weights.toSorted((a, b) => a - b),
  );
  assert.equal(line.marksOf(many, (time_s) => 2000 * time_s).length, many.length);
});

test("names are within the timeline and none lies over another; what counts most has its name", () => {
  const labels = line.labelsOf(many, (time_s) => 6 * (time_s - 200), 620);
  assert.ok(labels.length > 3);
  for (const { at, half } of labels) assert.ok(at - half >= 0 && at + half <= 620);
  for (const [k, one] of labels.entries())
    for (const other of labels.slice(k + 1)) assert.ok(Math.abs(one.at - other.at) >= one.half + other.half);
  const heaviest = Math.max(...many.slice(-60).map(({ kind }) => weightOf(kind)));
  assert.equal(weightOf(labels[0].kind), heaviest);
  assert.deepEqual(line.labelsOf([event(1, 5, "snap"), event(2, 6, "office")], x, 620), []); // they count too little
  const [only, ...none] = line.labelsOf([event(1, 5, "goal"), event(2, 6, "kidnap")], x, 620);
  assert.deepEqual([only.kind, none], ["kidnap", []]);
});

test("an event is told with its time and its name; what repeats is one line that counts, wherever it came from", () => {
  assert.equal(words({ ...event(1, 61, "unreachable"), text: "to 5" }), "1:01 no route: to 5");
  const several = (/** @type {number} */ k) => ({ ...event(k, 10 * k, "place"), line: "several", count: k });
  const news = [several(1), event(2, 15, "snap"), several(2), event(3, 21, "snap"), { ...several(3), since_s: 10 }];
  for (let k = 0; k <= news.length; k++) {
    const told = counted([...counted(news.slice(0, k)), ...news.slice(k)]); // in two messages of any length
    assert.equal(told.map(({ number }) => number).join(), "2,3,3");
    assert.equal(words(told[2]), "0:30 places: x, 3 times since 0:10");
  }
});

test("a span keeps its middle when it is made shorter, stays in the whole, and becomes the whole again", () => {
  const all = line.whole(1000);
  const near = line.zoomed(all, 0.1, 500, all);
  assert.ok(near && Math.abs(near.to - near.from - 103) < 1e-9);
  const share = (500 - near.from) / (near.to - near.from);
  assert.ok(Math.abs(share - 500 / 1030) < 1e-9);
  assert.equal(line.zoomed(near, 20, 500, all), null);
  const shortest = line.zoomed(near, 1e-9, 0, all);
  assert.ok(shortest && Math.abs(shortest.to - shortest.from - 5) < 1e-9 && shortest.from >= 0);
  assert.deepEqual(line.within({ from: 1000, to: 1100 }, all), { from: 930, to: 1030 });
});

test("times beneath a part are within it and round", () => {
  for (const [from, to] of path("100 105, 930 1030, 3600 7200")) {
    const times = tickTimesIn(from, to, 700);
    assert.ok(times.length >= 2 && times.length < 12, `${times}`);
    assert.ok(times.every((time) => time >= from && time <= to && Number.isInteger(time)));
  }
  assert.deepEqual(tickTimesIn(0, 60, 700), tickTimes(60, 700));
});

test("the next event and the one before", () => {
  const events = [event(1, 5, "snap"), event(2, 6, "office"), event(3, 9, "lost")];
  const next = (/** @type {number} */ from, /** @type {1 | -1} */ way) => nextEvent(events, from, way);
  assert.deepEqual([next(6, 1), next(6, -1), next(9, 1)], [9, 5, undefined]);
});

test("branches part where the first of them leaves the other", () => {
  const branches = [null, 1, 2, 1].map((parent, k) => ({
    number: k + 1,
    parent,
    from_s: [0, 40, 60, 20][k],
    end_s: 100,
  }));
  for (const [one, other, time_s] of [
    [1, 2, 40],
    [3, 1, 40],
    [2, 3, 60],
    [3, 4, 20],
    [4, 1, 20],
  ])
    assert.equal(parted(branches, one, other), time_s);
});

test("two maps lie in one frame, turned as on the stage", () => {
  const [[x, y]] = lying([[1, 0]], Math.PI / 2);
  assert.ok(Math.abs(x) < 1e-9 && Math.abs(y - 1) < 1e-9);
  const robot = { x: 0, y: 0, heading_rad: 0 };
  const sides = [[[3, 0]], [[0, -2]]].map((xy) => /** @type {SideFields} */ ({ xy, robot, turn_rad: 0 }));
  assert.equal(frameOf(sides), "-0.60 -0.60 4.20 3.20");
});

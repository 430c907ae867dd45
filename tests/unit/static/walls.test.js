// Walls that change because something else has changed.

import assert from "node:assert/strict";
import { test } from "node:test";
import { away, length } from "../../../web/static/editor/geometry.js";
import { fitted, gapSteps, looksOf, pulledEnds } from "../../../web/static/editor/walls.js";
import { chance, segment, wall } from "./made.js";

const board = { bottom: 1, top: 2, texture: /** @type {const} */ ("board"), colour: "#000000" };
const panel = (/** @type {number} */ at, /** @type {number} */ width) => ({ at, width, ...board });

test("a door takes its width out of the wall and leaves the rest where it was", () => {
  const next = chance(3);
  for (let k = 0; k < 100; k++) {
    const ends = segment(`${next() * 5} ${next() * 5}, ${8 + next() * 5} ${next() * 5}`);
    const world = { walls: [wall("0 -9, 9 -9"), { ...wall("0 0, 1 0"), from: ends[0], to: ends[1] }] };
    const whole = length(world.walls[1]);
    const [begin, width] = [0.1 + next() * (whole - 1.3), 0.9];
    const on = (/** @type {number} */ m) =>
      /** @type {Point} */ ([0, 1].map((c) => ends[0][c] + ((ends[1][c] - ends[0][c]) * m) / whole));
    const [from, to] = [on(begin), on(begin + width)];
    const steps = next() < 0.5 ? gapSteps(world, from, to) : gapSteps(world, to, from); // whichever way it is drawn
    assert.equal(
      steps.map((step) => `${step.do} ${step.list} ${step.number ?? ""}`).join(),
      "change walls 1,add walls ",
    );
    const [left, right] = steps.map((step) => /** @type {Wall} */ (step.item));
    assert.deepEqual([left.from, right.to], ends);
    assert.ok(away(left.to, from) < 0.001 && away(right.from, to) < 0.001);
    assert.ok(Math.abs(length(left) + length(right) + width - whole) < 0.003);
  }
});

test("at an end of the wall one part is left, over all of it none", () => {
  const world = { walls: [wall("0 0, 4 0")] };
  const left = (/** @type {Wall} */ item) => [{ do: "change", list: "walls", number: 0, item }];
  assert.deepEqual(gapSteps(world, [0, 0], [0.9, 0]), left(wall("0.9 0, 4 0")));
  assert.deepEqual(gapSteps(world, [3.1, 0], [4, 0]), left(wall("0 0, 3.1 0")));
  const gone = [{ do: "delete", list: "walls", number: 0 }];
  assert.deepEqual(gapSteps({ walls: [wall("0 0, 0.9 0")] }, [0, 0], [0.9, 0]), gone);
});

test("no gap where there is no inner wall that reaches the floor under all of the door", () => {
  for (const rest of [{ outer: true }, { bottom: 2 }])
    assert.deepEqual(gapSteps({ walls: [wall("0 0, 4 0", rest)] }, [1, 0], [2, 0]), []);
  const world = { walls: [wall("0 0, 4 0")] };
  assert.deepEqual(gapSteps(world, [1, 0.05], [2, 0]), []);
  assert.deepEqual(gapSteps(world, [3.5, 0], [4.4, 0]), []);
  assert.equal(gapSteps(world, [1, 0.02], [2, 0]).length, 2);
});

test("pictures stay where they hang, or go with what was taken away", () => {
  const hung = wall("0 0, 6 0", { panels: [panel(0.2, 0.5), panel(1.8, 0.8), panel(4, 1)] });
  const [left, right] = gapSteps({ walls: [hung] }, [1.5, 0], [2.4, 0]).map((step) => /** @type {Wall} */ (step.item));
  assert.deepEqual(left.panels, [panel(0.2, 0.5)]);
  assert.deepEqual(right.panels, [panel(1.6, 1)]); // from the new beginning: 4 m from the old one as before
  assert.deepEqual(fitted(wall("0 0, 2.6 0", { panels: hung.panels })).panels, [panel(0.2, 0.5), panel(1.8, 0.8)]);
  assert.equal("panels" in fitted(wall("0 0, 1 0")), false);
});

test("corners stay closed when one of their ends is pulled, and all others stay where they are", () => {
  const world = { walls: ["0 0, 4 0", "4 0, 4 3", "4 3, 0 3", "2 2, 4 0"].map((ends) => wall(ends)) };
  /** @param {string[]} ways @param {number[]} [without] */
  const pulled = (ways, without) =>
    pulledEnds(world, ways.map(segment), without).map(({ number, item }) => `${number}: ${item?.from} to ${item?.to}`);
  assert.deepEqual(pulled(["4 0, 5 1"], [0]), ["1: 5,1 to 4,3", "3: 2,2 to 5,1"]);
  assert.deepEqual(pulled(["9 9, 5 1"]), []);
  assert.ok(pulled(["4 0, 5 0", "4 3, 5 3"]).includes("1: 5,0 to 5,3"));
});

test("walls are drawn by what they are", () => {
  /** @type {[Partial<Wall>, string][]} */
  const looks = [
    [{ outer: true, kind: "glass" }, "outer"],
    [{ bottom: 2 }, "high"],
    [{ kind: "glass" }, "glass"],
    [{ kind: "wall" }, "wall"],
    [{ kind: "desk" }, "low"],
  ];
  for (const [rest, look] of looks) assert.equal(looksOf(wall("0 0, 1 0", rest)), look);
});

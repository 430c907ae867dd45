// The kinds of things: grips, moves, fields, names, what lies near a point.

import assert from "node:assert/strict";
import { test } from "node:test";
import { endNear, thingNear } from "../../../web/static/model/finding.js";
import { away, corners, tip } from "../../../web/static/model/geometry.js";
import { THINGS, kindOf, moved, newName, read, written } from "../../../web/static/model/things.js";
import { LIMITS } from "../../../web/static/shared.js";
import { wall } from "./chance.js";

/** @type {{ [L in ThingList]: Things[L] }} */
const ONE = {
  walls: wall([0, 0], [4, 0]),
  doors: { name: "door 1", hinge: [1, 1], angle_deg: 30, width: 0.9 },
  lamps: { name: "lamp 1", x: 2, y: 3 },
  boxes: { name: "box 1", x: 5, y: 5, width: 1, depth: 0.5, angle_deg: 20 },
  people: {
    name: "person 1",
    path: [
      [0, 0],
      [2, 0],
      [2, 2],
    ],
    wait_s: [1, 2, 3],
  },
  slow_zones: {
    name: "zone",
    corners: [
      [0, 0],
      [3, 0],
      [3, 3],
    ],
    factor: 0.5,
  },
  starts: { name: "start 1", x: 1, y: 1, heading_deg: 0 },
  places: { name: "desk", x: 7, y: 1 },
};
const LISTS = /** @type {ThingList[]} */ (Object.keys(THINGS));

test("whatever is shifted has its grips shifted, and shifted back it is what it was", () => {
  for (const list of LISTS) {
    const { grips, shift } = kindOf(list);
    const there = shift(ONE[list], [1.5, -2]);
    for (const [k, grip] of grips(there).entries())
      assert.ok(away(grip, [grips(ONE[list])[k][0] + 1.5, grips(ONE[list])[k][1] - 2]) < 0.0011, list);
    assert.deepEqual(shift(there, [-1.5, 2]), ONE[list], list);
  }
});

test("a grip that is pulled comes along, and the others of an open shape stay", () => {
  for (const list of LISTS) {
    const { grips, pull } = kindOf(list);
    grips(ONE[list]).forEach((_, k) => {
      const after = grips(pull(ONE[list], k, [6, 7]));
      assert.ok(
        after.some((grip) => away(grip, [6, 7]) < 0.02),
        `${list} ${k}`,
      );
      if (list === "boxes") return;
      for (const [j, grip] of after.entries())
        if (j !== k) assert.ok(away(grip, grips(ONE[list])[j]) < 0.02, `${list} ${k} ${j}`);
    });
  }
});

test("a box that is pulled at a corner keeps the one opposite, and is never thinner than can be gripped", () => {
  for (const k of [0, 1, 2, 3]) {
    const box = THINGS.boxes.pull(ONE.boxes, k, [8, 9]);
    assert.ok(
      corners(box).some((corner) => away(corner, corners(ONE.boxes)[(k + 2) % 4]) < 0.02),
      String(k),
    );
  }
  const flat = THINGS.boxes.pull(ONE.boxes, 2, corners(ONE.boxes)[0]);
  assert.deepEqual([flat.width, flat.depth], [0.05, 0.05]);
});

test("each thing is nought from its grips", () => {
  for (const list of LISTS)
    for (const grip of kindOf(list).grips(ONE[list])) assert.ok(kindOf(list).far(ONE[list], grip) < 0.001, list);
});

test("numbers that are typed in have the world file's limits, all of them", () => {
  const limits = /** @type {Record<string, Record<string, number[]>>} */ (LIMITS);
  for (const list of LISTS)
    for (const { key, type, low = NaN, high = NaN } of THINGS[list].fields.filter((field) => field.type === "number")) {
      const [least, most] = limits[list][key.split(".")[0]];
      assert.ok(low >= least && high === most, `${list} ${key} ${type}: ${low} to ${high}`);
    }
});

test("what is written at a key is read there, and nothing else is another", () => {
  const person = ONE.people;
  assert.equal(read(ONE.walls, "to.0"), 4);
  assert.deepEqual(written(ONE.walls, "to.0", 9), { ...ONE.walls, to: [9, 0] });
  assert.deepEqual(written(person, "wait_s.*", 7).wait_s, [7, 7, 7]);
  assert.deepEqual(written({ name: "p", path: person.path }, "wait_s.*", 7), {
    name: "p",
    path: person.path,
    wait_s: [7],
  });
  assert.deepEqual(
    [read(person, "wait_s.*"), read({ name: "p" }, "wait_s.*"), read(person, "name")],
    [1, undefined, "person 1"],
  );
  assert.deepEqual(ONE.walls.to, [4, 0]);
});

test("a new thing has the first name that is free", () => {
  assert.equal(newName({}, "lamps"), "lamp 1");
  assert.equal(newName({ lamps: [ONE.lamps, { ...ONE.lamps, name: "lamp 3" }] }, "lamps"), "lamp 2");
});

test("a wall that is moved leaves its neighbours, its end or an outer wall takes them along", () => {
  const world = {
    walls: [wall([0, 0], [4, 0]), wall([4, 0], [4, 3], { outer: true }), wall([4, 3], [0, 3], { outer: true })],
  };
  const pull = (/** @type {number} */ number, /** @type {number | null} */ grip) =>
    moved(world, { list: "walls", number, grip, item: world.walls[number] }, [4, 0], [5, 1]).steps.map((step) => [
      step.number,
      step.item?.from,
      step.item?.to,
    ]);
  assert.deepEqual(pull(0, null), [[0, [1, 1], [5, 1]]]);
  assert.deepEqual(pull(0, 1), [
    [0, [0, 0], [5, 1]],
    [1, [5, 1], [4, 3]],
  ]);
  assert.deepEqual(pull(1, null), [
    [1, [5, 1], [5, 4]],
    [0, [0, 0], [5, 1]],
    [2, [5, 4], [0, 3]],
  ]);
});

test("the small ones lie on the large ones, and who walks about is found where they are", () => {
  const world = {
    slow_zones: [ONE.slow_zones],
    people: [ONE.people],
    lamps: [{ ...ONE.lamps, x: 2.5, y: 1 }],
    walls: [ONE.walls],
  };
  assert.deepEqual(thingNear(world, [2.5, 1.02], 0.1), { list: "lamps", number: 0 });
  assert.deepEqual(thingNear(world, [2.6, 0.5], 0.1), { list: "slow_zones", number: 0 });
  assert.equal(thingNear(world, [9, 9], 0.1), null);
  assert.deepEqual(thingNear(world, [9, 9], 0.1, { "person 1": [9.2, 9, 0] }), { list: "people", number: 0 });
  const walls = { walls: [wall([0, 0], [1, 0]), wall([0, 0.08], [1, 0.08])] };
  assert.deepEqual(thingNear(walls, [0.5, 0.07], 0.1), { list: "walls", number: 1 }); // the nearer one
  assert.deepEqual(endNear(walls, [1.02, 0.06], 0.1), [1, 0.08]);
  assert.equal(endNear(walls, [0.5, 0], 0.1), null);
});

test("a door that is pulled at its hinge keeps its tip", () => {
  const door = THINGS.doors.pull(ONE.doors, 0, [1.2, 0.5]);
  assert.deepEqual(door.hinge, [1.2, 0.5]);
  assert.ok(away(tip(door), tip(ONE.doors)) < 0.003);
});

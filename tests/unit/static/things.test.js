// The kinds of things: grips, moves, fields, names, what lies near a point.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  endNear,
  kindOf,
  moved,
  newName,
  read,
  thingNear,
  THINGS,
  written,
} from "../../../web/static/editor/things.js";
import { away, corners, tip } from "../../../web/static/editor/geometry.js";
import { LIMITS } from "../../../web/static/shared.js";
import { path, wall } from "./made.js";

/** @type {{ [L in ThingList]: Things[L] }} */
const ONE = {
  walls: wall("0 0, 4 0"),
  doors: { name: "door 1", hinge: [1, 1], angle_deg: 30, width: 0.9 },
  lamps: { name: "lamp 1", x: 2, y: 3 },
  boxes: { name: "box 1", x: 5, y: 5, width: 1, depth: 0.5, angle_deg: 20 },
  people: { name: "person 1", path: path("0 0, 2 0, 2 2"), wait_s: [1, 2, 3] },
  slow_zones: { name: "zone", corners: path("0 0, 3 0, 3 3"), factor: 0.5 },
  starts: { name: "start 1", x: 1, y: 1, heading_deg: 0 },
  places: { name: "desk", x: 7, y: 1 },
};
const LISTS = /** @type {ThingList[]} */ (Object.keys(THINGS));

test("each thing is nought from its grips; shifted, its grips are shifted, and shifted back it is what it was", () => {
  for (const list of LISTS) {
    const { grips, shift, far } = kindOf(list);
    const there = shift(ONE[list], [1.5, -2]);
    grips(ONE[list]).forEach((grip, k) => {
      assert.ok(far(ONE[list], grip) < 0.001, list);
      assert.ok(away(grips(there)[k], [grip[0] + 1.5, grip[1] - 2]) < 0.0011, list);
    });
    assert.deepEqual(shift(there, [-1.5, 2]), ONE[list], list);
  }
});

test("a grip that is pulled comes along, and the others of an open shape stay", () => {
  for (const list of LISTS) {
    const { grips, pull } = kindOf(list);
    const before = grips(ONE[list]);
    for (const k of before.keys()) {
      const after = grips(pull(ONE[list], k, [6, 7]));
      assert.ok(Math.min(...after.map((grip) => away(grip, [6, 7]))) < 0.02, `${list} ${k}`);
      const moved = after.filter((grip, j) => j !== k && away(grip, before[j]) >= 0.02);
      if (list !== "boxes") assert.deepEqual(moved, [], `${list} ${k}`);
    }
  }
  const door = THINGS.doors.pull(ONE.doors, 0, [1.2, 0.5]); // at its hinge
  assert.deepEqual(door.hinge, [1.2, 0.5]);
  assert.ok(away(tip(door), tip(ONE.doors)) < 0.003);
});

test("a box that is pulled at a corner keeps the one opposite, and is never thinner than can be gripped", () => {
  for (const k of [0, 1, 2, 3]) {
    const opposite = corners(ONE.boxes)[(k + 2) % 4];
    const kept = corners(THINGS.boxes.pull(ONE.boxes, k, [8, 9])).map((corner) => away(corner, opposite));
    assert.ok(Math.min(...kept) < 0.02, String(k));
  }
  const flat = THINGS.boxes.pull(ONE.boxes, 2, corners(ONE.boxes)[0]);
  assert.deepEqual([flat.width, flat.depth], [0.05, 0.05]);
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
  const { people, walls } = ONE;
  const still = { name: "p", path: people.path };
  assert.equal(read(walls, "to.0"), 4);
  assert.deepEqual(written(walls, "to.0", 9), { ...walls, to: [9, 0] });
  assert.deepEqual(walls.to, [4, 0]);
  assert.deepEqual(written(people, "wait_s.*", 7).wait_s, [7, 7, 7]);
  assert.deepEqual(written(still, "wait_s.*", 7), { ...still, wait_s: [7] });
  const asked = [read(people, "wait_s.*"), read({ name: "p" }, "wait_s.*"), read(people, "name")];
  assert.deepEqual(asked, [1, undefined, "person 1"]);
});

test("a new thing has the first name that is free", () => {
  assert.equal(newName({}, "lamps"), "lamp 1");
  assert.equal(newName({ lamps: [ONE.lamps, { ...ONE.lamps, name: "lamp 3" }] }, "lamps"), "lamp 2");
});

test("a wall that is moved leaves its neighbours, its end or an outer wall takes them along", () => {
  const outer = { outer: true };
  const world = { walls: [wall("0 0, 4 0"), wall("4 0, 4 3", outer), wall("4 3, 0 3", outer)] };
  const pull = (/** @type {number} */ number, /** @type {number | null} */ grip) =>
    moved(world, { list: "walls", number, grip, item: world.walls[number] }, [4, 0], [5, 1])
      .steps.map(({ number, item }) => `${number}: ${item?.from} to ${item?.to}`)
      .join("; ");
  assert.equal(pull(0, null), "0: 1,1 to 5,1");
  assert.equal(pull(0, 1), "0: 0,0 to 5,1; 1: 5,1 to 4,3");
  assert.equal(pull(1, null), "1: 5,1 to 5,4; 0: 0,0 to 5,1; 2: 5,4 to 0,3");
});

test("the small ones lie on the large ones, and who walks about is found where they are", () => {
  const lamps = [{ ...ONE.lamps, x: 2.5, y: 1 }];
  const world = { slow_zones: [ONE.slow_zones], people: [ONE.people], lamps, walls: [ONE.walls] };
  assert.deepEqual(thingNear(world, [2.5, 1.02], 0.1), { list: "lamps", number: 0 });
  assert.deepEqual(thingNear(world, [2.6, 0.5], 0.1), { list: "slow_zones", number: 0 });
  assert.equal(thingNear(world, [9, 9], 0.1), null);
  assert.deepEqual(thingNear(world, [9, 9], 0.1, { "person 1": [9.2, 9, 0] }), { list: "people", number: 0 });
  const walls = { walls: [wall("0 0, 1 0"), wall("0 0.08, 1 0.08")] };
  assert.deepEqual(thingNear(walls, [0.5, 0.07], 0.1), { list: "walls", number: 1 }); // the nearer one
  assert.deepEqual(endNear(walls, [1.02, 0.06], 0.1), [1, 0.08]);
  assert.equal(endNear(walls, [0.5, 0], 0.1), null);
});

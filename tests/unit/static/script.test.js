// The lines of a world's script, and times as they are written.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  ACTIONS,
  firstAction,
  followingLines,
  isLevel,
  line,
  seconds,
  time,
} from "../../../web/static/model/script.js";
import { SCRIPT_ACTIONS } from "../../../web/static/shared.js";

/** @type {Partial<World>} */
const world = {
  doors: [
    { name: "front", hinge: [0, 0], angle_deg: 0, width: 1 },
    { name: "back", hinge: [3, 0], angle_deg: 0, width: 1 },
  ],
  lamps: [{ name: "front", x: 0, y: 0 }],
  script: [
    { at_s: 1, do: "open_door", name: "front" },
    { at_s: 2, do: "lamp_on", name: "front" },
    { at_s: 3, do: "people_on" },
    { at_s: 4, do: "close_door", name: "front" },
    { at_s: 5, do: "open_door", name: "back" },
  ],
};

test("every action of the world file has words", () => {
  assert.deepEqual(Object.keys(ACTIONS).sort(), [...SCRIPT_ACTIONS].sort());
});

test("a line holds what its action needs and nothing else", () => {
  assert.deepEqual(line(world, 9, "open_door", "back"), { at_s: 9, do: "open_door", name: "back" });
  assert.deepEqual(line(world, 9, "open_door", "gone"), { at_s: 9, do: "open_door", name: "front" });
  assert.deepEqual(line(world, 9, "box_appear", "gone"), { at_s: 9, do: "box_appear", name: "" });
  assert.deepEqual(line(world, 9, "people_off", "front"), { at_s: 9, do: "people_off" });
  assert.deepEqual(line(world, 9, "daylight", "0.3"), { at_s: 9, do: "daylight", level: 0.3 });
  assert.deepEqual(line(world, 9, "daylight", "front"), { at_s: 9, do: "daylight", level: 0.5 });
});

test("lines follow a new name, of its own list only, from behind", () => {
  assert.deepEqual(
    followingLines(world, "doors", "front", "main").map(({ do: what, number, item }) => [what, number, item?.name]),
    [
      ["change", 3, "main"],
      ["change", 0, "main"],
    ],
  );
  assert.deepEqual(
    followingLines(world, "doors", "front", null),
    [3, 0].map((number) => ({ do: "delete", list: "script", number })),
  );
  assert.deepEqual(followingLines({}, "doors", "front", null), []);
});

test("a time that is written is read as it was, to the millisecond", () => {
  for (const at_s of [0, 4.5, 59, 60, 90, 599.999, 3600, 3661.25, 86399]) assert.equal(seconds(time(at_s)), at_s);
  assert.deepEqual([time(90), time(3750), time(4.5)], ["1:30", "1:02:30", "0:04.5"]);
  assert.deepEqual([seconds("90"), seconds(" 1:30 "), seconds("1:02:30"), seconds("0:90")], [90, 90, 3750, 90]);
});

test("what is no time is none", () => {
  for (const text of ["", "a", "1:", ":5", "-3", "1:2:3:4", "1e3", "1,5", "0x10"])
    assert.ok(Number.isNaN(seconds(text)), text);
});

test("what is no level is none", () => {
  assert.deepEqual(["0", "1.5", 2].map(isLevel), [true, true, true]);
  assert.deepEqual([null, "", "  ", "front", "1,5"].map(isLevel), [false, false, false, false, false]);
});

test("the first action is one that this world has something for", () => {
  assert.deepEqual(
    [firstAction(world), firstAction({ lamps: world.lamps }), firstAction({}), firstAction(null)],
    ["open_door", "lamp_on", "daylight", "daylight"],
  );
});

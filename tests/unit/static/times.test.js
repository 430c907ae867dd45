// What happens when in a world: the lines of its script, times as they are written, and the curve of the daylight.

import assert from "node:assert/strict";
import { test } from "node:test";
import { BOTTOM, DaylightCurve, HEIGHT, LEFT, RIGHT, TOP, WIDTH } from "../../../web/static/editor/daylight.js";
import {
  ACTIONS,
  firstAction,
  followingLines,
  isLevel,
  line,
  seconds,
  time,
} from "../../../web/static/editor/times.js";
import { SCRIPT_ACTIONS } from "../../../web/static/shared.js";
import { path } from "./made.js";

const door = { angle_deg: 0, width: 1 };
/** @type {Partial<World>} */
const world = {
  doors: [
    { name: "front", hinge: [0, 0], ...door },
    { name: "back", hinge: [3, 0], ...door },
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

test("a line holds what its action needs and nothing else, and every action of the world file has words", () => {
  assert.deepEqual(Object.keys(ACTIONS).sort(), [...SCRIPT_ACTIONS].sort());
  for (const [action, which, rest] of /** @type {const} */ ([
    ["open_door", "back", { name: "back" }],
    ["open_door", "gone", { name: "front" }],
    ["box_appear", "gone", { name: "" }],
    ["people_off", "front", {}],
    ["daylight", "0.3", { level: 0.3 }],
    ["daylight", "front", { level: 0.5 }],
  ]))
    assert.deepEqual(line(world, 9, action, which), { at_s: 9, do: action, ...rest });
});

test("lines follow a new name, of its own list only, from behind", () => {
  const told = followingLines(world, "doors", "front", "main").map((step) => [step.do, step.number, step.item?.name]);
  assert.deepEqual(
    told,
    [3, 0].map((number) => ["change", number, "main"]),
  );
  const gone = [3, 0].map((number) => ({ do: "delete", list: "script", number }));
  assert.deepEqual(followingLines(world, "doors", "front", null), gone);
  assert.deepEqual(followingLines({}, "doors", "front", null), []);
});

test("a time that is written is read as it was, to the millisecond; what is no time or level is none", () => {
  for (const at_s of [0, 4.5, 59, 60, 90, 599.999, 3600, 3661.25, 86399]) assert.equal(seconds(time(at_s)), at_s);
  assert.deepEqual([90, 3750, 4.5].map(time), ["1:30", "1:02:30", "0:04.5"]);
  assert.deepEqual(["90", " 1:30 ", "1:02:30", "0:90"].map(seconds), [90, 90, 3750, 90]);
  for (const text of ["", "a", "1:", ":5", "-3", "1:2:3:4", "1e3", "1,5", "0x10"])
    assert.ok(Number.isNaN(seconds(text)), text);
  assert.ok(["0", "1.5", 2].every(isLevel));
  assert.ok(![null, "", "  ", "front", "1,5"].some(isLevel));
});

test("the first action is one that this world has something for", () => {
  assert.deepEqual([world, { lamps: world.lamps }, {}, null].map(firstAction), [
    "open_door",
    "lamp_on",
    "daylight",
    "daylight",
  ]);
});

/** @param {string} points @param {number} [repeat_s] */
const curve = (points, repeat_s = 0) => new DaylightCurve({ points: path(points), repeat_s });
/** @param {DaylightCurve} made */
const drawn = (made) => path(made.path.slice(1).replaceAll("L", ", "));
/** @param {DaylightCurve} made @param {number} level */
const height = (made, level) => Number(made.y(level).toFixed(1));

test("all of the daylight is in the picture, from its left to its right; later is further right, brighter is higher", () => {
  for (const made of [curve("0 1, 600 0, 900 3"), curve("100 2", 90), curve("5 0"), new DaylightCurve(null)]) {
    const places = drawn(made);
    assert.deepEqual([places[0][0], places.at(-1)?.[0]], [LEFT, WIDTH - RIGHT]);
    for (const [x, y] of places) assert.ok(x >= LEFT && x <= WIDTH - RIGHT && y >= TOP && y <= HEIGHT - BOTTOM);
  }
  const made = curve("0 1, 600 2");
  assert.ok(made.x(10) < made.x(20) && made.y(1) > made.y(1.5));
  assert.equal(made.x(99_999), WIDTH - RIGHT); // a moment past the end stays at the end
});

test("before its first point it is as at the first, after the last as at the last, without any as painted", () => {
  const [made, none] = [curve("60 0.5, 120 2"), new DaylightCurve(null)];
  const ys = drawn(made).map(([, y]) => y);
  assert.deepEqual([ys[0], ys[1], ys.at(-1)], [ys[1], height(made, 0.5), ys.at(-2)]);
  assert.deepEqual(
    drawn(none).map(([, y]) => y),
    [height(none, 1), height(none, 1)],
  );
});

test("a daylight that repeats begins its round again", () => {
  const made = curve("0 1, 50 0", 100);
  assert.deepEqual([made.now(130), made.span_s], [made.now(30), 100]);
  assert.equal(curve("0 1, 80 0").now(130), WIDTH - RIGHT);
});

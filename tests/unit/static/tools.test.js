// What the clicked points make.

import assert from "node:assert/strict";
import { test } from "node:test";
import { THINGS } from "../../../web/static/editor/things.js";
import { hintOf, toolOf, TOOLS } from "../../../web/static/editor/tools.js";
import { OFFICE_LISTS } from "../../../web/static/shared.js";
import { path, wall } from "./made.js";

const WORLD = /** @type {any} */ ({
  walls: [wall("0 0, 4 0")],
  starts: [],
  lamps: [{ name: "lamp 1", x: 0, y: 0 }],
});
/** @param {ToolName} tool @param {string} points */
const made = (tool, points) => TOOLS[tool].makes?.(path(points), WORLD, { kind: "glass", height: 2 }) ?? "nothing";

test("every tool has a key of its own, is found by it, and says what to click for each of its points", () => {
  const names = /** @type {ToolName[]} */ (Object.keys(TOOLS));
  for (const name of names) {
    const { key, takes = 1, says, list } = TOOLS[name];
    assert.equal(toolOf(key), name);
    assert.equal(toolOf(key.toUpperCase()), name);
    assert.ok(says.length >= Math.min(takes, 3), name);
    assert.ok(list === undefined || (list in THINGS && OFFICE_LISTS.includes(list)));
  }
  assert.equal(toolOf("q"), undefined);
  assert.deepEqual(
    [hintOf("wall", 0), hintOf("wall", 1), hintOf("wall", 9)],
    [TOOLS.wall.says[0], TOOLS.wall.says[1], TOOLS.wall.says[1]],
  );
});

test("each tool adds one thing to its list", () => {
  for (const [tool, points, item] of /** @type {[ToolName, string, object][]} */ ([
    ["wall", "0 0, 1 2", { from: [0, 0], to: [1, 2], kind: "glass", height: 2 }],
    ["lamp", "1 2", { name: "lamp 2", x: 1, y: 2, reach: 4, brightness: 0.5, on: true }],
    ["box", "2 3, 1 1", { name: "box 1", x: 1.5, y: 2, width: 1, depth: 2 }],
    ["person", "1 1", { name: "person 1", path: path("1 1"), loop: false }],
    ["zone", "0 0, 1 0, 1 1", { name: "slow zone 1", corners: path("0 0, 1 0, 1 1"), factor: 0.5 }],
    ["start", "1 1, 1 4", { name: "start 1", x: 1, y: 1, heading_deg: 90 }],
    ["place", "5 6", { name: "place 1", x: 5, y: 6 }],
  ]))
    assert.deepEqual(made(tool, points), [{ do: "add", list: TOOLS[tool].list, item }], tool);
});

test("a door makes its gap in an inner wall", () => {
  const steps = made("door", "1 0, 2 0");
  assert.ok(Array.isArray(steps));
  assert.equal(steps.map((step) => `${step.do} ${step.list}`).join(), "change walls,add walls,add doors");
  assert.deepEqual(steps[2].item, { name: "door 1", hinge: [1, 0], angle_deg: 0, width: 1 });
});

test("what cannot be is refused by a sentence with its size and what would be right", () => {
  for (const [points, size] of [
    ["0 5, 0.2 5", "0.2"],
    ["0 5, 7 5", "7"],
  ])
    assert.equal(made("door", points), `A door is 0.3 to 6 m wide; this one would be ${size} m.`);
  assert.equal(made("box", "0 0, 1 0.04"), "A box is at least 0.05 m each way; this one would be 1 × 0.04 m.");
});

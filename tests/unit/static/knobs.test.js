// Parameters as controls, and what the parts of a tick cost, in words.

import assert from "node:assert/strict";
import { test } from "node:test";
import { groupOf, grouped, isDefault, means, printed, shortName } from "../../../web/static/model/knobs.js";
import { partWords, shareOf, tickWords } from "../../../web/static/model/timings.js";

const SPEED = { name: "pilot.cruise_speed", symbol: "v", unit: "m/s", hint: "How fast it drives. Default: 0.3." };

test("a parameter is called by its last name, in the group of the others", () => {
  assert.equal(shortName("pilot.cruise_speed"), "cruise speed");
  assert.equal(groupOf("experience_map.links.age"), "experience map.links");
  assert.equal(groupOf("seed"), "all");
  const groups = grouped([{ name: "a.x" }, { name: "b.x" }, { name: "a.y" }]);
  assert.deepEqual(
    [...groups],
    [
      ["a", [{ name: "a.x" }, { name: "a.y" }]],
      ["b", [{ name: "b.x" }]],
    ],
  );
});

test("a search means a parameter when each of its words is somewhere in it", () => {
  for (const search of ["", "cruise", "CRUISE speed", "cruise_speed", "m/s", "drives", "fast pilot"])
    assert.ok(means(SPEED, search), search);
  for (const search of ["cruise map", "rad", "0.35"]) assert.ok(!means(SPEED, search), search);
});

test("what follows an underscore of a symbol is printed below the line", () => {
  assert.deepEqual(["s_m", "n_x'", "delta", "t_{max}"].map(printed), [
    ["s", "m"],
    ["n", "x'"],
    ["delta", ""],
    ["t", "max"],
  ]);
});

test("a way back is there when the value is another than the default", () => {
  assert.ok(isDefault({ value: 0.3, default: 0.3 }));
  assert.ok(!isDefault({ value: false, default: true }));
});

test("a tick's parts are told against the time there is, and drawn against the dearest", () => {
  /** @type {import("../../../web/static/model/timings.js").Timing[]} */
  const parts = [
    ["view match", 0.25, 0.7],
    ["attractor", 0.5, 1.04],
  ];
  assert.equal(tickWords(parts, 100), "A tick takes 0.75 of its 100 ms");
  assert.equal(partWords(parts[1]), "0.50, worst 1.0 ms");
  assert.deepEqual(
    parts.map((part) => shareOf(parts, part)),
    [0.5, 1],
  );
  assert.equal(tickWords([], 50), "A tick takes 0.00 of its 50 ms");
});

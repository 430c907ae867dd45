// Parameters as controls, and what the parts of a tick cost, in words.

import assert from "node:assert/strict";
import { test } from "node:test";
import { grouped, groupOf, isDefault, means, printed, shortName } from "../../../web/static/panel/tune.js";
import { partWords, shareOf, tickWords } from "../../../web/static/panel/tick.js";

const SPEED = { name: "pilot.cruise_speed", symbol: "v", unit: "m/s", hint: "How fast it drives. Default: 0.3." };

test("a parameter is called by its last name, in the group of the others", () => {
  assert.equal(shortName("pilot.cruise_speed"), "cruise speed");
  assert.deepEqual(["experience_map.links.age", "seed"].map(groupOf), ["experience map.links", "all"]);
  const [ax, bx, ay] = ["a.x", "b.x", "a.y"].map((name) => ({ name }));
  assert.deepEqual(Object.fromEntries(grouped([ax, bx, ay])), { a: [ax, ay], b: [bx] });
});

test("a search means a parameter when each of its words is somewhere in it", () => {
  for (const search of ["", "cruise", "CRUISE speed", "cruise_speed", "m/s", "drives", "fast pilot"])
    assert.ok(means(SPEED, search), search);
  assert.ok(means({ ...SPEED, symbol: "σ_ε" }, "sigma"), "a symbol as people type it");
  for (const search of ["cruise map", "rad", "0.35"]) assert.ok(!means(SPEED, search), search);
});

test("what follows an underscore of a symbol is printed below the line; a way back is there off the default", () => {
  const printing = { s_m: ["s", "m"], "n_x'": ["n", "x'"], delta: ["delta", ""], "t_{max}": ["t", "max"] };
  for (const [symbol, parts] of Object.entries(printing)) assert.deepEqual(printed(symbol), parts);
  assert.ok(isDefault({ value: 0.3, default: 0.3 }));
  assert.ok(!isDefault({ value: false, default: true }));
});

test("a tick's parts are told against the time there is, and drawn against the dearest", () => {
  /** @type {import("../../../web/static/panel/tick.js").Timing[]} */
  const parts = [
    ["view match", 0.25, 0.7],
    ["attractor", 0.5, 1.04],
  ];
  assert.equal(tickWords(parts, 100), "A tick takes 0.75 of its 100 ms");
  assert.equal(tickWords([], 50), "A tick takes 0.00 of its 50 ms");
  assert.equal(partWords(parts[1]), "0.50, worst 1.0 ms");
  assert.deepEqual([shareOf(parts, parts[0]), shareOf(parts, parts[1])], [0.5, 1]);
});

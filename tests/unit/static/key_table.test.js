import assert from "node:assert/strict";
import { test } from "node:test";

import { GROUPS, actOf, written } from "../../../web/static/model/key_table.js";

const rows = GROUPS.flatMap((group) => group.rows.map((row) => row));

test("no key has two meanings, and none of them drives", () => {
  const keys = rows.flatMap((row) => [...row.keys]);
  assert.equal(new Set(keys).size, keys.length);
  for (const key of keys) assert.ok(!["w", "a", "s", "d"].includes(key), key);
});

test("every key does what the help says", () => {
  for (const { keys, act } of rows) for (const key of keys) assert.equal(actOf(key), act);
  assert.equal(actOf("y"), undefined);
});

test("keys are written as on keyboards", () => {
  assert.deepEqual([" ", "Escape", "?"].map(written), ["space", "esc", "?"]);
});

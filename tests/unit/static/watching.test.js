// A page that only looks on.

import assert from "node:assert/strict";
import { test } from "node:test";
import { actOf, GROUPS } from "../../../web/static/model/key_table.js";
import { isLook, KEYS, looksOn, newId } from "../../../web/static/model/watching.js";

test("its id says so, and is as hard to guess as any other", () => {
  assert.match(newId(true), /^watch-[0-9a-f]{32}$/);
  assert.match(newId(false), /^[0-9a-f]{32}$/);
  assert.ok(looksOn(newId(true)) && !looksOn(newId(false)));
});

test("it says what concerns itself alone", () => {
  for (const kind of ["view", "theme", "tabs", "got"]) assert.ok(isLook(kind));
  for (const kind of ["kidnap", "switch", "replay", "present", "vote"]) assert.ok(!isLook(kind));
});

test("its keys are keys of the page, and none of them steers", () => {
  const acts = GROUPS.flatMap(({ rows }) => rows.map(({ act }) => act));
  for (const act of KEYS) assert.ok(acts.includes(act), act);
  for (const key of ["k", "e", " ", ".", "b", "x", "m", "o", "c", "PageDown"])
    assert.ok(!KEYS.has(actOf(key) ?? "escape"), key);
});

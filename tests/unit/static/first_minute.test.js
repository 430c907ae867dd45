// The three things that a newcomer does.

import assert from "node:assert/strict";
import { test } from "node:test";
import { FirstMinute } from "../../../web/static/model/first_minute.js";

test("each thing is done when it has happened, in any order", () => {
  const first = new FirstMinute();
  first.at(FirstMinute.TICKS - 1);
  first.hear([{ kind: "recovered" }, { kind: "goal" }]);
  assert.deepEqual([first.explored, first.reached, first.found], [false, false, false]);
  first.hear([{ kind: "kidnap" }, { kind: "lost" }, { kind: "recovered" }]);
  assert.equal(first.found, true);
  first.at(FirstMinute.TICKS);
  assert.equal(first.done, false);
  first.hear([{ kind: "arrived" }]);
  assert.equal(first.done, true);
});

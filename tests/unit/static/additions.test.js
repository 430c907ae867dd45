// Our additions as choices for a second brain.

import assert from "node:assert/strict";
import { test } from "node:test";
import { additionChoice, additionGroups } from "../../../web/static/model/additions.js";
import { ADDITIONS } from "../../../web/static/shared.js";

const names = ADDITIONS.map(({ name }) => name);
const ON = { beginning: [], now: [] };

test("all are offered once, and a group that would be empty is not", () => {
  assert.deepEqual(
    additionGroups(ON).map((group) => group.names),
    [names],
  );
  const groups = additionGroups({ beginning: ["carry"], now: [] });
  assert.equal(groups.length, 2);
  assert.deepEqual(groups[1].names, ["carry"]);
  assert.deepEqual(new Set(groups.flatMap((group) => group.names)), new Set(names));
});

test("each says what it adds and why, and the buttons say which way it goes", () => {
  assert.deepEqual(additionChoice("carry", { beginning: ["carry"], now: [] }), {
    about:
      "A packet goes as far as the wheels say, along the arc driven: what the attractor swallows is added to the next movement, and the spread of its headings divided out: an attractor pins slow packets to the lattice of its cells, and spread headings shorten the way.",
    anew: "Begin again with it",
    now: "From now on without it",
  });
});

test("what a running brain cannot change begins with a run only", () => {
  const choice = additionChoice("exact solver", ON);
  assert.equal(choice.anew, "Begin again without it");
  assert.equal(choice.now, "");
});

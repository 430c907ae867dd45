// Which keys mean what, and where.

import assert from "node:assert/strict";
import { test } from "node:test";
import { directionOf, meaningOf } from "../../../web/static/model/key_meanings.js";

const NOWHERE = { typing: false, arrows: false, pressing: false, dialog: false };
/** @param {string} code @param {string} key @param {object} [rest] */
const pressed = (code, key, rest = {}) => ({
  code,
  key,
  ctrlKey: false,
  metaKey: false,
  altKey: false,
  isComposing: false,
  ...rest,
});

test("arrows and W A S D drive, by where they lie on the keyboard", () => {
  const drives = ["ArrowUp", "KeyW", "ArrowDown", "KeyS", "ArrowLeft", "KeyA", "ArrowRight", "KeyD"];
  assert.deepEqual(drives.map(directionOf), ["up", "up", "down", "down", "left", "left", "right", "right"]);
  assert.deepEqual(meaningOf(pressed("KeyW", "z"), NOWHERE), { drive: "up" }); // a French keyboard
  assert.deepEqual(meaningOf(pressed("KeyZ", "w"), NOWHERE), { act: "w" });
});

test("an arrow is the slider's, a letter drives also there", () => {
  assert.equal(meaningOf(pressed("ArrowLeft", "ArrowLeft"), { ...NOWHERE, arrows: true }), null);
  assert.deepEqual(meaningOf(pressed("KeyA", "a"), { ...NOWHERE, arrows: true }), { drive: "left" });
});

test("nothing is taken from who types, nor from the browser's own keys", () => {
  for (const code of ["KeyW", "KeyK", "Space"]) {
    assert.equal(meaningOf(pressed(code, "k"), { ...NOWHERE, typing: true }), null);
    for (const flag of ["ctrlKey", "metaKey", "altKey", "isComposing"])
      assert.equal(meaningOf(pressed(code, "k", { [flag]: true }), NOWHERE), null);
  }
});

test("space is the button's that has the focus, and play and pause elsewhere", () => {
  assert.equal(meaningOf(pressed("Space", " "), { ...NOWHERE, pressing: true }), null);
  assert.deepEqual(meaningOf(pressed("Space", " "), NOWHERE), { act: " " });
  assert.deepEqual(meaningOf(pressed("KeyK", "K"), { ...NOWHERE, pressing: true }), { act: "k" });
});

test("a dialog takes all keys but the one for help", () => {
  for (const [code, key] of [
    ["KeyW", "w"],
    ["ArrowUp", "ArrowUp"],
    ["Escape", "Escape"],
    ["KeyK", "k"],
  ])
    assert.equal(meaningOf(pressed(code, key), { ...NOWHERE, dialog: true }), null);
  assert.deepEqual(meaningOf(pressed("Slash", "?"), { ...NOWHERE, dialog: true }), { act: "?" });
});

test("Escape keeps its name, letters are small", () => {
  assert.deepEqual(meaningOf(pressed("Escape", "Escape"), NOWHERE), { act: "Escape" });
  assert.deepEqual(meaningOf(pressed("KeyE", "E"), NOWHERE), { act: "e" });
});

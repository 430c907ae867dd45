// A click on the plates is a press that is let go where it began, however late; where it was is told in halves of the height.

import assert from "node:assert/strict";
import { test } from "node:test";
import { takeClicks } from "../../../web/static/viewer/viser_client.js";

const CANVAS = { tagName: "CANVAS", getBoundingClientRect: () => ({ left: 10, top: 20, width: 400, height: 200 }) };

/** What comes of a press with one finger or button, and of what follows. @param {[string, object][]} events */
function clicked(...events) {
  const [inside, clicks] = [new EventTarget(), /** @type {unknown[]} */ ([])];
  takeClicks(/** @type {any} */ (inside), (...click) => clicks.push(click));
  for (const [kind, fields] of events) {
    const told = { pointerId: 1, isPrimary: true, button: 0, clientX: 260, clientY: 70, shiftKey: false, ...fields };
    const event = new Event(kind);
    for (const [name, value] of Object.entries({ target: CANVAS, ...told }))
      Object.defineProperty(event, name, { value });
    inside.dispatchEvent(event);
  }
  return clicks;
}

test("a press that is let go where it began is a click there", () => {
  assert.deepEqual(clicked(["pointerdown", {}], ["pointerup", {}]), [[[0.5, 0.5], false]]);
  const trembling = { clientX: 264, clientY: 67 };
  assert.deepEqual(clicked(["pointerdown", { shiftKey: true }], ["pointermove", trembling], ["pointerup", trembling]), [
    [[0.5, 0.5], true],
  ]);
});

test("a drag, another button, a second finger and what is not a canvas are none", () => {
  const far = { clientX: 268 };
  assert.deepEqual(clicked(["pointerdown", {}], ["pointermove", far], ["pointermove", {}], ["pointerup", {}]), []);
  assert.deepEqual(clicked(["pointerdown", { button: 2 }], ["pointerup", { button: 2 }]), []);
  const second = { pointerId: 2, isPrimary: false };
  assert.deepEqual(clicked(["pointerdown", {}], ["pointerdown", second], ["pointerup", second], ["pointerup", {}]), []);
  assert.deepEqual(clicked(["pointerdown", {}], ["pointercancel", {}], ["pointerup", {}]), []);
  assert.deepEqual(clicked(["pointerdown", { target: { tagName: "DIV" } }], ["pointerup", {}]), []);
});

// A part of the panel, framed as the server does it: arrays come out as they went in.

import assert from "node:assert/strict";
import { test } from "node:test";
import { unframed } from "../../../web/static/model/frames.js";

/**
 * Frames a message as web/panel/packing.py does.
 * @param {object} head
 * @param {[string, string, number[], ArrayBufferView][]} arrays
 * @returns {ArrayBuffer}
 */
function framed(head, arrays) {
  const listed = arrays.map(([name, kind, shape, { byteLength }]) => ({ name, kind, shape, bytes: byteLength }));
  const text = JSON.stringify({ ...head, arrays: listed });
  const bytes = new TextEncoder().encode(text + " ".repeat((4 - (new TextEncoder().encode(text).length % 4)) % 4));
  const lengths = arrays.map(([, , , { byteLength }]) => Math.ceil(byteLength / 4) * 4);
  const whole = new Uint8Array(4 + bytes.length + lengths.reduce((sum, length) => sum + length, 0));
  new DataView(whole.buffer).setUint32(0, bytes.length, true);
  whole.set(bytes, 4);
  let at = 4 + bytes.length;
  arrays.forEach(([, , , view], k) => {
    whole.set(new Uint8Array(view.buffer, view.byteOffset, view.byteLength), at);
    at += lengths[k];
  });
  return whole.buffer;
}

test("arrays of every kind come out as they went in, whatever lies before them", () => {
  for (let odd = 0; odd < 6; odd++) {
    /** @type {[string, string, number[], ArrayBufferView][]} */
    const arrays = [
      ["bytes", "u1", [odd], new Uint8Array(odd).fill(7)],
      ["places", "u4", [2], new Uint32Array([5, 4_000_000_000])],
      ["strength", "u2", [3], new Uint16Array([1, 2, 65535])],
      ["turns", "f4", [2], new Float32Array([0.5, -1])],
      ["camera", "jpeg", [48, 64, 3], new Uint8Array([255, 216, odd])],
    ];
    const message = unframed(framed({ type: "panel", data: { words: "θ′ ".repeat(odd) } }, arrays));
    assert.equal(message.type, "panel");
    assert.equal(message.data.words, "θ′ ".repeat(odd));
    for (const [name, kind, shape, view] of arrays) {
      assert.deepEqual([message.arrays[name].kind, message.arrays[name].shape], [kind, shape]);
      assert.deepEqual([...message.arrays[name].values], [.../** @type {any} */ (view)]);
    }
  }
});

test("a message without arrays is its head", () => {
  assert.deepEqual(unframed(framed({ part: "memory", has: [] }, [])), { part: "memory", has: [], arrays: {} });
});

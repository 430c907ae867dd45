// What comes from the server: arrays in frames, and what a route tells, or why nothing can be had of it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { unframed } from "../../../web/static/net/connection.js";
import { get } from "../../../web/static/net/post.js";

/**
 * Frames a message as web/panel/panel.py does.
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

test("arrays of every kind come out as they went in, whatever lies before them; without arrays there is the head", () => {
  for (let odd = 0; odd < 6; odd++) {
    /** @type {[string, string, number[], ArrayBufferView][]} */
    const arrays = [
      ["bytes", "u1", [odd], new Uint8Array(odd).fill(7)],
      ["places", "u4", [2], new Uint32Array([5, 4_000_000_000])],
      ["strength", "u2", [3], new Uint16Array([1, 2, 65535])],
      ["turns", "f4", [2], new Float32Array([0.5, -1])],
      ["camera", "jpeg", [48, 64, 3], new Uint8Array([255, 216, odd])],
    ];
    const data = { words: "θ′ ".repeat(odd) };
    const { arrays: told, ...head } = unframed(framed({ type: "panel", data }, arrays));
    assert.deepEqual(head, { type: "panel", data });
    for (const [name, kind, shape, view] of arrays) {
      assert.deepEqual([told[name].kind, told[name].shape], [kind, shape]);
      assert.deepEqual([...told[name].values], [.../** @type {any} */ (view)]);
    }
  }
  assert.deepEqual(unframed(framed({ part: "memory", has: [] }, [])), { part: "memory", has: [], arrays: {} });
});

test("what a route returns comes as it is, or why not in sentences; whatever hangs is given up", async (context) => {
  /** @type {unknown} */
  let signal;
  /** @param {typeof fetch} answers @returns {Promise<{ data: unknown, wrong: string }>} */
  const got = (answers) => {
    context.mock.method(globalThis, "fetch", answers);
    return get("/api/lessons");
  };
  const found = await got(async (_path, options) => {
    signal = options?.signal;
    return Response.json([1]);
  });
  assert.deepEqual(found, { data: [1], wrong: "" });
  assert.ok(signal instanceof AbortSignal);
  const refused = await got(async () => Response.json({ detail: [{ reason: "not now" }] }, { status: 503 }));
  assert.deepEqual(refused, { data: null, wrong: "Not now." });
  const lost = await got(() => Promise.reject(new TypeError("Failed to fetch")));
  assert.match(lost.wrong, /connection is lost/);
  const late = await got(() => Promise.reject(new DOMException("signal timed out", "TimeoutError")));
  assert.match(late.wrong, /did not answer/);
});

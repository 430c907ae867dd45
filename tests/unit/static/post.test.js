// What a route tells, or why nothing can be had of it: also when it hangs.

import assert from "node:assert/strict";
import { test } from "node:test";
import { get } from "../../../web/static/net/post.js";

/** @param {typeof fetch} answers @returns {Promise<{ told: unknown, wrong: string }>} */
async function got(answers) {
  const before = globalThis.fetch;
  globalThis.fetch = answers;
  try {
    return await get("/api/lessons");
  } finally {
    globalThis.fetch = before;
  }
}

test("what is told comes as it is", async () => {
  assert.deepEqual(await got(async () => Response.json([1])), { told: [1], wrong: "" });
});

test("a refusal comes in sentences", async () => {
  const refused = async () => Response.json({ detail: [{ reason: "not now" }] }, { status: 503 });
  assert.deepEqual(await got(refused), { told: null, wrong: "Not now." });
});

test("a connection that is lost and one that hangs are told apart", async () => {
  const lost = await got(() => Promise.reject(new TypeError("Failed to fetch")));
  const late = await got(() => Promise.reject(new DOMException("signal timed out", "TimeoutError")));
  assert.match(lost.wrong, /connection is lost/);
  assert.match(late.wrong, /did not answer/);
});

test("whatever hangs is given up", async () => {
  /** @type {unknown} */
  let signal;
  await got(async (_path, options) => {
    signal = options?.signal;
    return Response.json([]);
  });
  assert.ok(signal instanceof AbortSignal);
});

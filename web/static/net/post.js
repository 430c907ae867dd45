// What the routes return, and changes that are not commands: JSON sent to one of them.

import { sentence } from "../ui/words.js";

/**
 * Resolves to the server's answer. If something was wrong, `wrong` says what, in sentences, and `field` says where.
 * @param {string} path
 * @param {object} body
 * @param {AbortSignal} [signal] gives it up
 * @returns {Promise<Reply>}
 */
export async function post(path, body, signal) {
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
      signal,
    });
    const data = await answer.json();
    if (answer.ok) return data;
    return { wrong: reasons(data), field: data.detail[0].field };
  } catch {
    return { wrong: "The connection is lost; nothing was changed.", field: null };
  }
}

const ANSWERED_MS = 20_000;

/**
 * What lies at an address, or why it cannot be had, in sentences. Whatever hangs is given up: a list would stay empty for ever.
 * @template T
 * @param {string} path
 * @returns {Promise<{ data: T | null, wrong: string }>}
 */
export async function get(path) {
  try {
    const answer = await fetch(path, { signal: AbortSignal.timeout(ANSWERED_MS) });
    const data = await answer.json();
    return answer.ok ? { data, wrong: "" } : { data: null, wrong: reasons(data) };
  } catch (error) {
    const late = error instanceof DOMException && error.name === "TimeoutError";
    return {
      data: null,
      wrong: late ? "The program did not answer. Close this and try again." : "The connection is lost.",
    };
  }
}

/** The worlds that have been saved, and those that come with the program: titles by name. @returns {Promise<WorldTitles>} */
export async function worlds() {
  try {
    return await (await fetch("/api/worlds")).json();
  } catch {
    return { yours: {}, ours: {} };
  }
}

/** What is wrong, in sentences. @param {{ detail: Wrong[] }} refusal */
export const reasons = ({ detail }) => detail.map((wrong) => sentence(wrong.reason)).join(" ");

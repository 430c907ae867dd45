// The real program, one for all of these tests, and its API as a person with curl would use it.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";

const PATIENCE_MS = 1000 * Number(process.env.PATIENCE_S ?? 120); // longer than any machine needs
/** What takes long runs in the largest tier only; see docs/testing.md. */
export const long = { skip: !process.env.LONG };
// The engine may take longer to answer than a person would wait, and these tests are quicker than a person.
const START = `import web.http.asking; web.http.asking.ANSWER_TIMEOUT_S = ${PATIENCE_MS / 1000}; \
from web.http.security import Bucket; Bucket.take = lambda self: True; \
from app.__main__ import main; raise SystemExit(main())`;

const CLASS = ["--class", "--class-port", "0", "--class-address", "127.0.0.1"];

const place = mkdtempSync(join(tmpdir(), "page-"));
/** The folder of the worlds that are saved. */
export const own = join(place, "worlds");
const interpreter = process.env.PYTHON ?? join(import.meta.dirname, "../../.venv/bin/python");
const python = spawn(
  interpreter,
  ["-c", START, "run", "--no-browser", "--port", "0", "--seed", "5", "--paused", ...CLASS],
  {
    env: {
      ...process.env,
      PYTHONUNBUFFERED: "1",
      RATSLAM_WORLDS: own,
      RATSLAM_RUNS: join(place, "runs"),
      RATSLAM_EXPERIMENTS: join(place, "experiments.sqlite"),
    },
    stdio: ["ignore", "pipe", "inherit"],
  },
);
for (const signal of ["SIGINT", "SIGTERM"]) process.on(signal, () => process.exit(1));
process.on("exit", () => {
  python.kill();
  rmSync(place, { recursive: true, force: true });
});
const ended = new Promise((resolve) => python.on("exit", resolve));

/** Where the page is, and where a class votes. @type {string[]} */
export const [url, door] = await new Promise((resolve, reject) => {
  let said = "";
  python.stdout.on("data", (words) => {
    said += words;
    const found = [/alive at (http:\S+)/, /votes at (http:\S+)/].map((sentence) => sentence.exec(said)?.[1] ?? "");
    if (found.every(Boolean)) resolve(found);
  });
  ended.then(() => reject(new Error(said)));
});
await until("it is awake", async () => (await fetch(`${url}healthz`)).ok);

after(async () => {
  python.kill("SIGINT");
  const code = await ended;
  if (code !== 0) throw new Error(`it ended with ${code}`);
});

/**
 * The first answer that is not false; it fails when there is none, with what was waited for.
 * @template T
 * @param {string} what
 * @param {() => T | Promise<T>} found
 */
export async function until(what, found) {
  const end = performance.now() + PATIENCE_MS;
  for (;;) {
    const answer = await found();
    if (answer) return answer;
    if (performance.now() > end) throw new Error(`not within ${PATIENCE_MS / 1000} s: ${what}`);
    await new Promise((go) => setTimeout(go, 5));
  }
}

/** What lines of Python print, run beside the program in a folder that is deleted afterwards. @param {string} lines */
export const byPython = (lines) => execFileSync(interpreter, ["-c", lines], { cwd: place, encoding: "utf-8" });

/** @param {string} route @returns {Promise<any>} */
export const told = async (route) => (await fetch(`${url}api/${route}`)).json();

/** @returns {Promise<any>} */
export const state = () => told("state");

/** @param {string} route @param {object} body @returns {Promise<any>} */
export async function post(route, body) {
  const headers = { "Content-Type": "application/json" };
  const answer = await fetch(`${url}api/${route}`, { method: "POST", headers, body: JSON.stringify(body) });
  const said = await answer.json();
  if (!answer.ok) throw new Error(JSON.stringify(said));
  return said;
}

/** @param {string} type @param {object} fields */
export const command = (type, fields = {}) => post("commands", { type, ...fields });

/** @type {string | undefined} */
let begun; // the session's hash, at the first begin

/** As if it had just been started: paused in the office, which nobody has edited. */
export async function begin() {
  await command("pause");
  await command("set_speed", { factor: 1 });
  await command("reset", { world: "loop" });
  await command("reset", { world: "office", seed: 5 });
  const { state_hash } = await post("situation", {});
  const before = begun ?? state_hash;
  begun = state_hash;
  assert.equal(state_hash, before, "the test before left a parameter");
}

// Recordings: one that was dropped on the page or chosen is sent as it is, and the server says what is wrong with it. While one
// plays, what it lacks is not on the page.

import { $, find } from "../ui/elements.js";
import { ended, megabytes } from "../ui/words.js";

const OFFICE_TABS = ["Office"];

/** Where the session comes from: an office that is simulated, or a recording. */
export class Source {
  /** @param {import("../panel/panel.js").Panel} panel */
  constructor(panel) {
    this.panel = panel;
    this.shown = "";
    /** @type {RecordingFields | null} */
    this.recording = null;
  }

  /** @param {RecordingFields | null} recording */
  show(recording) {
    this.recording = recording;
    const truth = recording === null || recording.has.includes("truth");
    const now = `${recording?.name} ${truth}`;
    if (now === this.shown) return;
    this.shown = now;
    document.body.dataset.source = recording ? "recording" : "office";
    document.body.dataset.truth = String(truth);
    find(document, 'button[data-view="office"]').textContent = recording ? "True path" : "Office";
    this.panel.hide([...(recording ? OFFICE_TABS : []), ...(truth ? [] : ["Truth"])]);
    $("restart-words").textContent = recording ? "Play from the beginning with seed" : "Restart with seed";
  }

  /** Why an order to the robot or the office is not carried out, or null. */
  get lacks() {
    return this.recording && "A recording plays: it has no office, and its robot goes where it went.";
  }
}

const RECORDING =
  /\.(mcap|bag|db3|log|clf|carmen|mp4|avi|mkv|mov|webm|m4v|mpe?g|tar|tgz|tbz2?|txz|zip|7z|rar)(\.(gz|bz2|xz|zst))?$/i;
const MOST_BYTES = 900_000_000;
const AT_ONCE = 4; // files of a folder on their way

/** @typedef {{ name: string, files: { path: string, file: File }[] }} Folder paths are within the folder */

/** @param {File} file */
export const isRecording = ({ name }) => RECORDING.test(name);

/** Sends it. Returns what is wrong, in sentences, or "" when it plays. @param {File} file */
export async function play(file) {
  if (file.size > MOST_BYTES) return tooLarge(file.name, file.size);
  try {
    return await send("POST", { name: file.name }, file);
  } catch {
    return `${file.name} could not be sent.`;
  }
}

/**
 * Sends the files of a folder, some at once. Returns what is wrong, in sentences, or "" when it plays.
 * @param {Folder} folder
 * @param {(words: string) => void} tell how far it is
 */
export async function playFolder({ name, files }, tell) {
  const whole = files.reduce((sum, { file }) => sum + file.size, 0);
  if (!files.length) return `${name}: there is no file in this folder.`;
  if (whole > MOST_BYTES) return tooLarge(name, whole);
  const folder = crypto
    .getRandomValues(new Uint32Array(4))
    .reduce((text, part) => text + part.toString(16).padStart(8, "0"), "");
  const waiting = [...files];
  let [sent, bytes, wrong] = [0, 0, ""];
  const one = async () => {
    for (let next = waiting.shift(); next && !wrong; next = waiting.shift()) {
      const said = await send("PUT", { folder, of: name, name: next.path }, next.file);
      wrong ||= said;
      sent += 1;
      bytes += next.file.size;
      tell(
        `Sending ${name}: ${sent.toLocaleString("en")} of ${files.length.toLocaleString("en")} files, ${megabytes(bytes)} of ${megabytes(whole)} …`,
      );
    }
  };
  try {
    await Promise.all(Array.from({ length: AT_ONCE }, one));
    if (wrong) return wrong;
    tell(`Looking over ${name} …`);
    return await send("POST", { folder, name }, new Blob());
  } catch {
    return `${name} could not be sent.`;
  }
}

/** All files of a folder that was dropped, with those in its folders. @param {FileSystemDirectoryEntry} entry @returns {Promise<Folder>} */
export async function dropped(entry) {
  /** @type {Folder} */
  const folder = { name: entry.name, files: [] };
  /** @param {FileSystemDirectoryEntry} place @param {string} under */
  const look = async (place, under) => {
    for (const each of await within(place))
      if (each.isDirectory) await look(/** @type {FileSystemDirectoryEntry} */ (each), `${under}${each.name}/`);
      else
        folder.files.push({
          path: under + each.name,
          file: await fileOf(/** @type {FileSystemFileEntry} */ (each)),
        });
  };
  await look(entry, "");
  return folder;
}

/** What is in a folder, without what is hidden. @param {FileSystemDirectoryEntry} place @returns {Promise<FileSystemEntry[]>} */
async function within(place) {
  const reader = place.createReader();
  /** @type {FileSystemEntry[]} */
  const all = [];
  for (;;) {
    /** @type {FileSystemEntry[]} */
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject)); // a hundred at a time
    if (!some.length) return all.filter(({ name }) => !name.startsWith("."));
    all.push(...some);
  }
}

/** @param {FileSystemFileEntry} entry @returns {Promise<File>} */
const fileOf = (entry) => new Promise((resolve, reject) => entry.file(resolve, reject));

/** The folder that was chosen. @param {File[]} files with their paths, which begin with the folder's name @returns {Folder} */
export function chosen(files) {
  const name = files[0].webkitRelativePath.split("/")[0];
  const parts = files.map((file) => ({ path: file.webkitRelativePath.slice(name.length + 1), file }));
  return { name, files: parts.filter(({ path }) => !/(^|\/)\./.test(path)) };
}

/** @param {"POST" | "PUT"} method @param {Record<string, string>} query @param {Blob} body what is wrong, or "" */
async function send(method, query, body) {
  const answer = await fetch(`/api/recordings?${new URLSearchParams(query)}`, {
    method,
    headers: { "Content-Type": "application/octet-stream" },
    body,
  });
  if (answer.ok) return "";
  return (await answer.json()).detail.map((/** @type {Wrong} */ wrong) => ended(wrong.reason)).join(" ");
}

/** @param {string} name @param {number} size */
const tooLarge = (name, size) =>
  `${name}: ${megabytes(size)}; at most ${megabytes(MOST_BYTES)}. Larger ones play by ratslam run --recording PATH.`;

// A recording that was dropped on the page or chosen: it is sent as it is, and the server says what is wrong with it.

import { ended, megabytes } from "../model/sentences.js";

const RECORDING = /\.(mcap|bag|db3|log|clf|carmen|mp4|avi|mkv|mov|webm|m4v|mpe?g)(\.(gz|bz2))?$/i;
const MOST_BYTES = 900_000_000;

/** @param {File} file */
export const isRecording = ({ name }) => RECORDING.test(name);

/** Sends it. Returns what is wrong, in sentences, or "" when it plays. @param {File} file */
export async function play(file) {
  if (file.size > MOST_BYTES)
    return `${file.name}: ${megabytes(file.size)}; at most ${megabytes(MOST_BYTES)}. Larger ones play by ratslam run --recording PATH.`;
  try {
    const answer = await fetch(`/api/recordings?name=${encodeURIComponent(file.name)}`, {
      method: "POST",
      headers: { "Content-Type": "application/octet-stream" },
      body: file,
    });
    if (answer.ok) return "";
    return (await answer.json()).detail.map((/** @type {Wrong} */ wrong) => ended(wrong.reason)).join(" ");
  } catch {
    return `${file.name} could not be sent.`;
  }
}

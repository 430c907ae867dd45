// A saved brain as a file: it is sent as it is; the server says in a sentence what is wrong with it.

import { $ } from "../ui/elements.js";
import { toast } from "../ui/toasts.js";
import { sentence } from "../ui/words.js";

/** The run begins anew with the brain of the file that is chosen. */
export function takeBrainFiles() {
  const input = $("brain-file");
  $("brain-load").addEventListener("click", () => {
    $("restart").open = false;
    input.click();
  });
  input.addEventListener("change", () => {
    if (input.files?.length) send(input.files[0]);
    input.value = ""; // so that the same file can be chosen again
  });
}

/** @param {File} file */
async function send(file) {
  const headers = { "Content-Type": "application/octet-stream" };
  try {
    const answer = await fetch("/api/brain", { method: "POST", headers, body: file });
    const told = await answer.json();
    if (answer.ok) toast(`Started anew with the brain of ${file.name}.`);
    else for (const wrong of told.detail) toast(sentence(wrong.reason), { bad: true });
  } catch {
    toast(`${file.name} could not be sent.`, { bad: true });
  }
}

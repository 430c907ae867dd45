// The run as a file for other programs: a dialog with the formats, and the download of the one that was chosen.

import { $, make } from "../ui/elements.js";
import { toast } from "../ui/words.js";
import { reasons } from "../net/post.js";
import { download } from "./pictures.js";

/** @typedef {{ format: string, words: string, refusal: string | null }} Offer */

const LOOK_MS = 500;

export class Exports {
  /** @param {() => [number, number] | null} marks the stretch that is marked on the timeline, simulated seconds */
  constructor(marks) {
    this.marks = marks;
    /** @type {AbortController | null} */
    this.writing = null;
    $("export-close").addEventListener("click", () => $("export-dialog").close());
    $("export-cancel").addEventListener("click", () => this.writing?.abort());
  }

  async open() {
    $("export-wrong").hidden = true;
    const marks = this.marks();
    $("export-marks").hidden = marks === null;
    [$("export-from").value, $("export-until").value] = marks?.map((time_s) => time_s.toFixed(1)) ?? ["", ""];
    $("export-dialog").showModal();
    try {
      this.show(await (await fetch("/api/exports")).json());
    } catch {
      this.fails("The connection is lost.");
    }
  }

  /** @param {Offer[]} offers */
  show(offers) {
    $("export-list").replaceChildren(...offers.map((offer) => this.row(offer)));
    if (!offers.length) this.fails("This program has no formats to offer.");
  }

  /** @param {Offer} offer */
  row({ format, words, refusal }) {
    const button = make("button", { type: "button", textContent: words, disabled: refusal !== null });
    button.addEventListener("click", () => this.save(format));
    const row = make("li", {}, button);
    if (refusal) row.append(make("small", { textContent: `Not now: ${refusal}.` }));
    return row;
  }

  // A run that is played again takes a while, so the page says how far it is; the dialog may be closed meanwhile.
  /** @param {string} format */
  async save(format) {
    if (this.writing) return this.fails("Another file is being written; wait until it is there, or cancel it.");
    const query = new URLSearchParams({ to: format, pictures: $("export-pictures").value });
    for (const [name, field] of Object.entries({ from_s: $("export-from"), until_s: $("export-until") })) {
      if (!field.checkValidity()) return this.fails("From and to are seconds from 0 on.");
      if (field.value) query.set(name, field.value);
    }
    this.writing = new AbortController();
    const { signal } = this.writing;
    $("export-wrong").hidden = true;
    $("export-busy").hidden = false;
    $("export-doing").textContent = `Writing ${format}.`;
    const looking = setInterval(() => this.look(), LOOK_MS);
    this.look();
    try {
      const answer = await fetch(`/api/export?${query}`, { signal });
      if (answer.ok) this.download(await answer.blob(), answer.headers.get("Content-Disposition") ?? "", format);
      else this.fails(reasons(await answer.json()));
    } catch {
      if (signal.aborted) toast(`The ${format} was not written.`);
      else this.fails("The connection is lost; the file was not written.");
    }
    clearInterval(looking);
    $("export-busy").hidden = true;
    this.writing = null;
  }

  async look() {
    const bar = /** @type {HTMLProgressElement} */ ($("export-done"));
    const share = await fetch("/api/exports/done").then(
      (answer) => answer.json(),
      () => null,
    );
    if (share) bar.value = share;
    else bar.removeAttribute("value"); // nobody knows yet
  }

  /** @param {Blob} blob @param {string} disposition @param {string} format */
  download(blob, disposition, format) {
    const name = /filename="([^"]+)"/.exec(disposition)?.[1] ?? `run.${format}`;
    download(blob, name);
    $("export-dialog").close();
    toast(`Saved ${name}.`);
  }

  /** @param {string} words */
  fails(words) {
    $("export-wrong").textContent = words;
    $("export-wrong").hidden = false;
    if (!$("export-dialog").open) toast(words, { bad: true });
  }
}

// The run as a file for other programs: a dialog with the formats, and the download of the one that was chosen.

import { make } from "../elements/elements.js";
import { $ } from "../elements/dom.js";
import { toast } from "../elements/toasts.js";
import { reasons } from "../net/post.js";

/** @typedef {{ format: string, words: string, refusal: string | null }} Offer */

export class Exports {
  constructor() {
    this.busy = false;
    $("export-close").addEventListener("click", () => $("export-dialog").close());
  }

  async open() {
    $("export-wrong").hidden = true;
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

  // A run that is played again takes a while, so the page says what it waits for; the dialog may be closed meanwhile.
  /** @param {string} format */
  async save(format) {
    if (this.busy) return this.fails("Another file is being written; wait until it is there.");
    this.busy = true;
    $("export-wrong").hidden = true;
    $("export-doing").textContent = `Writing ${format}. A long run takes a while.`;
    try {
      const answer = await fetch(`/api/export?to=${encodeURIComponent(format)}`);
      if (answer.ok) this.download(await answer.blob(), answer.headers.get("Content-Disposition") ?? "", format);
      else this.fails(reasons(await answer.json()));
    } catch {
      this.fails("The connection is lost; the file was not written.");
    }
    $("export-doing").textContent = "";
    this.busy = false;
  }

  /** @param {Blob} blob @param {string} disposition @param {string} format */
  download(blob, disposition, format) {
    const name = /filename="([^"]+)"/.exec(disposition)?.[1] ?? `run.${format}`;
    const url = URL.createObjectURL(blob);
    make("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 60_000);
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

// The moment that is shown, for somebody else: as a link, as a file, and as lines of Python.

import { $ } from "../ui/elements.js";
import { download } from "./download.js";
import { fine } from "../ui/words.js";
import { momentWords, sizeWords } from "../model/moments.js";
import { post } from "../net/post.js";
import { toast } from "../ui/toasts.js";

export class Share {
  /** @param {() => { plate: ViewName, tab: string, page: string }} look what this page shows */
  constructor(look) {
    this.look = look;
    /** @type {Moment | null} */
    this.moment = null;
    $("share-close").addEventListener("click", () => $("share-dialog").close());
    $("share-copy").addEventListener("click", () => this.copy($("share-link").value, "The link", $("share-link")));
    $("share-save").addEventListener("click", () => this.save());
    $("share-copy-python").addEventListener("click", () =>
      this.copy($("share-python").value, "The lines", $("share-python")),
    );
  }

  /** The whole address of a link. @param {string} link */
  address(link) {
    return `${location.origin}/#${link}`;
  }

  /** Asks for the moment that is shown; null: the reason has been said. @returns {Promise<Moment | null>} */
  async ask() {
    const told = await post("/api/situation", this.look());
    if (told.wrong) toast(told.wrong, { bad: true });
    this.moment = told.wrong ? null : /** @type {Moment} */ (/** @type {unknown} */ (told));
    return this.moment;
  }

  /** Shows the link and copies it; where it fits into none, says why. */
  async link() {
    const moment = await this.ask();
    if (!moment) return;
    this.show(moment);
    if (moment.link) await this.copy(this.address(moment.link), "The link", $("share-link"));
  }

  async python() {
    const moment = await this.ask();
    if (!moment) return;
    this.show(moment);
    $("share-python").focus();
    $("share-python").scrollIntoView({ block: "nearest" });
  }

  async file() {
    if (await this.ask()) this.save();
  }

  save() {
    if (!this.moment) return;
    download(new Blob([this.moment.file], { type: "application/json" }), this.moment.name);
    toast(`Saved ${this.moment.name}.`);
  }

  /** @param {Moment} moment */
  show(moment) {
    const { link, why, file, name, python } = moment;
    $("share-words").textContent = momentWords(moment, fine(moment.time_s));
    $("share-has-link").hidden = link === null;
    $("share-no-link").hidden = link !== null;
    $("share-no-link").textContent = why;
    $("share-link").value = link ? this.address(link) : "";
    $("share-length").textContent = `${$("share-link").value.length.toLocaleString("en")} characters`;
    $("share-file").textContent = `${name}, ${sizeWords(file.length)}`;
    $("share-python").value = python;
    $("share-python").rows = Math.min(16, python.split("\n").length);
    if (!$("share-dialog").open) $("share-dialog").showModal();
  }

  /** @param {string} text @param {string} what @param {HTMLTextAreaElement} field */
  async copy(text, what, field) {
    let done = false;
    try {
      await navigator.clipboard.writeText(text);
      done = true;
    } catch {
      field.select(); // this browser gives pages no clipboard: what is selected can be copied by hand
      done = document.execCommand("copy");
    }
    const words = done ? `${what}: copied, ${text.length.toLocaleString("en")} characters.` : "Select it and copy it.";
    $("share-told").textContent = words;
    toast(words, { bad: !done });
  }
}

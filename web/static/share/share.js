// The moment that is shown, for somebody else: as a link, as a file, and as lines of Python. What somebody else has made of a moment
// is opened from the address of the page or from a file, and shown as they saw it.

import { $, find, say, setIcon } from "../ui/elements.js";
import { download } from "./pictures.js";
import { fine, toast } from "../ui/words.js";
import { post } from "../net/post.js";

/** @param {Moment} moment @param {string} time */
export function momentWords({ tick, state_hash, orders }, time) {
  const given = orders === 0 ? "no orders" : orders === 1 ? "one order" : `${orders.toLocaleString("en")} orders`;
  return `${time}, tick ${tick}, with ${given}. Whoever opens it plays the run up to here and gets the same bits: state hash ${state_hash.slice(0, 12)}.`;
}

/** @param {number} bytes */
const sizeWords = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

/** The link in an address; null: there is none. @param {string} hash */
export const linkIn = (hash) => /^#(run=.+)$/.exec(hash)?.[1] ?? null;

/** What the note says while a situation is played, and when it is there. @param {SituationFields} situation */
export function situationWords({ state, tick, end_tick, words }) {
  const titles = {
    playing: "Playing up to the moment",
    same: "The same run",
    other: "Not the same run",
    stopped: "Not there",
  };
  const far = `tick ${tick.toLocaleString("en")} of ${end_tick.toLocaleString("en")}`;
  return { title: titles[state], words: state === "playing" ? far : words, share: end_tick ? tick / end_tick : 1 };
}

/** The moment as a link, as a file, and as lines of Python. */
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
    const reply = await post("/api/situation", this.look());
    if (reply.wrong) toast(reply.wrong, { bad: true });
    this.moment = reply.wrong ? null : /** @type {Moment} */ (/** @type {unknown} */ (reply));
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

const ICONS = /** @type {const} */ ({ playing: "share", same: "check", other: "warn", stopped: "warn" });

/** Opens what somebody else has made of a moment, and shows it as they saw it. */
export class Opening {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {{ mayLeave: () => Promise<boolean>, look: (look: Look) => void }} page
   */
  constructor(link, page) {
    this.link = link;
    this.page = page;
    this.begun = false;
    this.looked = -1; // the run whose look has been taken over
    this.away = -1; // the run whose note was put away
    this.run = -1;
    window.addEventListener("hashchange", () => this.address());
    $("situation-close").addEventListener("click", () => {
      this.away = this.run;
      $("situation").hidden = true;
    });
  }

  /** A link in the page's address is opened once; then the address is the page's own again, so that a reload changes nothing. */
  async address() {
    const link = linkIn(location.hash);
    if (!link) return;
    history.replaceState(null, "", location.pathname);
    await this.open(link, "The link");
  }

  /** Opens the file if it is a situation. False: it is something else. @param {File} file */
  async offer(file) {
    if (!/\.json$/i.test(file.name) || !(await file.slice(0, 200).text()).includes('"ratslam situation/')) return false;
    await this.open(await file.text(), file.name);
    return true;
  }

  /** @param {string} text @param {string} what */
  async open(text, what) {
    if (!(await this.page.mayLeave())) return;
    const reply = await post("/api/situation/open", { text });
    if (reply.wrong) toast(`${what} cannot be opened. ${reply.wrong}`, { bad: true });
  }

  /** What arrives: how far it is. @param {PageFields} page */
  show({ situation, run }) {
    if (!this.begun) {
      this.begun = true;
      this.address();
    }
    const box = $("situation");
    this.run = run;
    box.hidden = !situation || this.away === run;
    if (!situation) return;
    if (this.looked !== run) {
      this.looked = run;
      this.page.look(situation.look);
    }
    const { title, words, share } = situationWords(situation);
    box.dataset.state = situation.state;
    setIcon(find(box, ".head"), ICONS[situation.state]);
    say(find(box, ".head b"), title);
    say(find(box, ".words"), words);
    const bar = /** @type {HTMLProgressElement} */ (find(box, "progress"));
    const playing = situation.state === "playing";
    bar.hidden = !playing;
    bar.value = share;
  }
}

// How much of the page is in sight: Watch, what a lecture needs; Explore, what one turns to next; Lab, all of it. What is there from
// a level on says so in the page (`data-from`). Each viewer's choice is remembered.

import { $, keep, kept } from "./elements.js";
import { toast } from "./words.js";

/** @typedef {(typeof LEVELS)[number]} Level */
export const LEVELS = /** @type {const} */ (["watch", "explore", "lab"]);
const KEY = "level";

export class Levels extends EventTarget {
  /** @param {boolean} watching a page that only looks on is as its presenter's may be: nothing that is told is left out */
  constructor(watching) {
    super();
    /** @type {Level} */
    this.now = watching ? "lab" : (LEVELS.find((name) => name === kept(KEY)) ?? "watch");
    for (const name of LEVELS) $(`level-${name}`).addEventListener("click", () => this.choose(name));
    this.show(this.now);
  }

  /** @param {Level} name */
  choose(name) {
    keep(KEY, name);
    this.show(name);
  }

  /** Something is about to be shown that is there from this level on. What the viewer chose stays kept. @param {Level} name */
  need(name) {
    if (this.has(name)) return;
    this.show(name);
    const title = $(`level-${name}`).textContent;
    toast(`This is in ${title}: the page shows ${title} now.`, { notice: true });
  }

  /** @param {Level} name */
  has(name) {
    return LEVELS.indexOf(name) <= LEVELS.indexOf(this.now);
  }

  /** @param {Level} name */
  show(name) {
    const before = this.now;
    this.now = document.body.dataset.level = name;
    for (const other of LEVELS) $(`level-${other}`).setAttribute("aria-pressed", String(other === name));
    if (name !== before) this.dispatchEvent(new CustomEvent("level", { detail: { before } }));
  }
}

// The run that was cut off, or the brain that an earlier program kept: a quiet offer over the plates, until somebody has answered it on any page.

import { $ } from "../elements/dom.js";
import { experiences, keptWords } from "../model/sentences.js";
import { post } from "../net/post.js";
import { toast } from "../elements/toasts.js";

export class KeptBrain {
  /** @param {(world: string) => Promise<boolean>} mayLeave whether the office as it is now may be left for that world */
  constructor(mayLeave) {
    this.mayLeave = mayLeave;
    this.box = $("kept");
    this.asked = false;
    /** @type {KeptOffer | null} */
    this.kept = null;
    $("kept-wake").addEventListener("click", () => this.wake());
    $("kept-not-now").addEventListener("click", () => this.answer(false));
    document.addEventListener("visibilitychange", () => !document.hidden && !this.box.hidden && this.look());
  }

  // Called once there is a state; before that, nothing could be woken up.
  ask() {
    if (this.asked) return;
    this.asked = true;
    this.look();
  }

  async look() {
    try {
      this.kept = await (await fetch("/api/brain/kept")).json();
    } catch {
      return; // the connection is lost; what is shown stays
    }
    if (this.kept) this.show(this.kept);
    this.box.hidden = !this.kept;
  }

  /** @param {KeptOffer} kept */
  show(kept) {
    $("kept-words").textContent = keptWords(kept, Date.now() / 1000);
    $("kept-title").textContent = kept.run ? "A run was cut off." : "A brain was kept.";
    $("kept-wake").textContent = kept.run ? "Go on with the run" : "Wake it up";
    $("kept-wake").title = kept.run
      ? "Go on where it was, with its map, its world and its orders"
      : "Begin anew with this brain, in its world and with its seed";
    this.box.setAttribute("aria-label", kept.run ? "A run that was cut off" : "A brain that was kept");
  }

  async wake() {
    if (this.kept && (await this.mayLeave(this.kept.world))) await this.answer(true);
  }

  /** @param {boolean} use */
  async answer(use) {
    for (const button of this.box.querySelectorAll("button")) button.disabled = true;
    const { wrong } = await post("/api/brain/kept", { use });
    for (const button of this.box.querySelectorAll("button")) button.disabled = false;
    if (wrong) toast(wrong, { bad: true });
    else if (use && this.kept?.run) toast(`The run in ${this.kept.title} goes on where it was.`);
    else if (use && this.kept) toast(`Started anew in ${this.kept.title} with ${experiences(this.kept.experiences)}.`);
    await this.look();
  }
}

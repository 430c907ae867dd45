// The brain that an earlier program kept: a quiet offer over the plates, until somebody has answered it on any page.

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
    if (this.kept) $("kept-words").textContent = keptWords(this.kept, Date.now() / 1000);
    this.box.hidden = !this.kept;
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
    else if (use && this.kept) toast(`Started anew in ${this.kept.title} with ${experiences(this.kept.experiences)}.`);
    await this.look();
  }
}

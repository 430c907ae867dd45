// Puts what happens into the page's live region, in breaths of some seconds.

import { $ } from "../ui/elements.js";
import { Speech } from "../model/speech.js";

const BREATH_MS = 3000;

export class Speaker {
  constructor() {
    this.speech = new Speech();
    this.silent = true; // until something waits
  }

  /** Events that have just happened. @param {TimelineEvent[]} events */
  hear(events) {
    this.speech.hear(events, performance.now() / 1000);
    if (this.silent) this.speak();
  }

  speak() {
    const words = this.speech.next();
    this.silent = words === "";
    if (this.silent) return;
    $("said").textContent = words;
    setTimeout(() => this.speak(), BREATH_MS);
  }
}

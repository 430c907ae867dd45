// Asks for moments of the past, one at a time: while one is on its way, only the newest wish waits. A moment that takes long is
// given up for a newer wish; where the pointer has come to rest, at once, but not twice running: a slow drag rests at each step.

const PATIENCE_MS = 150;
const RESTED_MS = 25;
const LOOK_MS = 10;

export class Seeker {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.link = link;
    /** @type {Seek | null} */
    this.wish = null;
    this.wished = 0; // when, ms
    this.busy = false;
    this.gaveUp = false; // the last moment, before it came
    /** @type {number | null} */
    this.aim = null; // the tick asked for last, until the page is told of it: quick steps count from here
  }

  /** The page has been told of a moment. What comes after an answer is not older than it. */
  told() {
    if (!this.busy) this.aim = null;
  }

  /** @param {Omit<Seek, "type">} where */
  async seek(where) {
    this.wish = { type: "seek", ...where };
    this.wished = performance.now();
    this.aim = where.tick ?? null;
    if (this.busy) return;
    this.busy = true;
    while (this.wish) {
      const wish = this.wish;
      this.wish = null;
      await this.answered(wish);
    }
    this.busy = false;
  }

  /** Waits for the answer, or until a newer wish has waited for long enough. @param {Seek} wish */
  async answered(wish) {
    let here = false;
    const answer = this.link.ask(wish).then(() => {
      here = true;
    });
    const asked = performance.now();
    const isOver = () =>
      performance.now() - asked > PATIENCE_MS || (!this.gaveUp && performance.now() - this.wished > RESTED_MS);
    while (!here && !(this.wish && isOver()))
      await Promise.race([answer, new Promise((resolve) => setTimeout(resolve, LOOK_MS))]);
    this.gaveUp = !here;
  }
}

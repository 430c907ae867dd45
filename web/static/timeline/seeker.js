// Asks for moments of the past, one at a time: while one is on its way, only the newest wish waits. A moment that takes long is
// given up for a newer wish.

const PATIENCE_MS = 150;
const LOOK_MS = 30;

export class Seeker {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.link = link;
    /** @type {Seek | null} */
    this.wish = null;
    this.busy = false;
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
    while (!here && !(this.wish && performance.now() - asked > PATIENCE_MS))
      await Promise.race([answer, new Promise((resolve) => setTimeout(resolve, LOOK_MS))]);
  }
}

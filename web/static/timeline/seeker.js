// Asks for moments of the past, one at a time: while one is on its way, only the newest wish waits.

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
      await this.link.ask(wish);
    }
    this.busy = false;
  }
}

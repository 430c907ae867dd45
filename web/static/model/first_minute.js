// The three things that a newcomer does, and when each is done. No DOM.

export class FirstMinute {
  explored = false;
  reached = false;
  found = false;
  #moved = false; // kidnapped, and not found again

  /** Ticks of exploring before the robot knows enough to be sent somewhere: three minutes. */
  static TICKS = 1800;

  /** @param {number} tick */
  at(tick) {
    this.explored ||= tick >= FirstMinute.TICKS;
  }

  /** @param {{ kind: string }[]} events those that have just happened */
  hear(events) {
    for (const { kind } of events) {
      if (kind === "arrived") this.reached = true;
      else if (kind === "kidnap") this.#moved = true;
      else if (kind === "recovered" && this.#moved) this.found = true;
    }
  }

  /** Whether it is on its way back to where it knows its place. */
  get searches() {
    return this.#moved && !this.found;
  }

  get done() {
    return this.explored && this.reached && this.found;
  }
}

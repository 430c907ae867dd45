// Moments of the past, asked for one at a time: while one is on its way, only the newest wish waits. A moment that takes long is
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

/** Pointers on the timeline: one drags the moment that is shown, two pinch the span; the wheel changes the span, too. */
export class Pointers {
  /** @param {import("./timeline.js").Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    this.place = timeline.place;
    /** @type {Map<number, number>} */
    this.down = new Map(); // pointer -> clientX
    this.place.addEventListener("pointerdown", (event) => this.press(event));
    this.place.addEventListener("mousedown", (event) => event.preventDefault()); // the arrows go on driving
    this.place.addEventListener("pointermove", (event) => this.move(event));
    for (const end of /** @type {const} */ (["pointerup", "pointercancel"]))
      this.place.addEventListener(end, (event) => this.release(event));
    this.place.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  /** @param {PointerEvent} event */
  press(event) {
    if (event.button > 0) return;
    this.place.setPointerCapture(event.pointerId);
    this.down.set(event.pointerId, event.clientX);
    if (this.down.size > 1) return;
    const near = this.timeline.near(event.clientX).at(-1);
    if (near) this.timeline.drag(near.time_s);
    else this.timeline.drag(this.timeline.timeAt(event.clientX));
  }

  /** @param {PointerEvent} event */
  move(event) {
    const was = this.down.get(event.pointerId);
    if (was === undefined || was === event.clientX) return;
    const [a, b] = [...this.down.values()];
    this.down.set(event.pointerId, event.clientX);
    if (this.down.size === 1) this.timeline.drag(this.timeline.timeAt(event.clientX));
    else {
      const [c, d] = [...this.down.values()];
      const factor = Math.max(20, Math.abs(a - b)) / Math.max(20, Math.abs(c - d));
      this.timeline.zoom(factor, this.timeline.timeAt((c + d) / 2));
    }
  }

  /** @param {PointerEvent} event */
  release(event) {
    this.down.delete(event.pointerId);
    if (this.down.size === 0) this.timeline.letGo();
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const across = Math.abs(event.deltaX) > Math.abs(event.deltaY) || event.shiftKey;
    if (across) this.timeline.pan((event.deltaX || event.deltaY) / this.place.clientWidth);
    else this.timeline.zoom(1.002 ** event.deltaY, this.timeline.timeAt(event.clientX));
  }
}

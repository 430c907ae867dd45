// Pointers on the timeline: one drags the moment that is shown, two pinch the span; the wheel changes the span, too.

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

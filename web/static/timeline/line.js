// Which part of a run the timeline shows, by pointers too, and which marks, names and times have room on it.

import { nameOf, weightOf } from "./events.js";

const [LETTER_PX, AROUND_PX] = [7.2, 5]; // width of a letter, and room on either side of a name
const NAMED = 60; // of the events that count, this many of the newest get names
const APART_PX = 5; // a second mark of the same kind within this distance would say nothing

/** @typedef {(time_s: number) => number} Axis where a time is, pixels */

/**
 * The marks to draw. Those that count most come last, and so on top.
 * @param {TimelineEvent[]} events oldest first
 * @param {Axis} x
 */
export function marksOf(events, x) {
  const marks = [];
  const last = new Map(); // kind -> x of the mark drawn last
  for (const { kind, time_s } of events) {
    const at = x(time_s);
    if (at - (last.get(kind) ?? -Infinity) < APART_PX) continue;
    last.set(kind, at);
    marks.push({ kind, at });
  }
  return marks.sort((a, b) => weightOf(a.kind) - weightOf(b.kind));
}

/**
 * The names to write, none over another. Those that count most go first; among equals, the newest.
 * @param {TimelineEvent[]} events
 * @param {Axis} x
 * @param {number} width
 */
export function labelsOf(events, x, width) {
  const wanted = events.filter((event) => weightOf(event.kind) > 1).slice(-NAMED);
  wanted.sort((a, b) => weightOf(b.kind) - weightOf(a.kind) || b.time_s - a.time_s);
  /** @type {{ kind: string, at: number, half: number }[]} */
  const labels = [];
  for (const { kind, time_s } of wanted) {
    const half = (nameOf(kind).length * LETTER_PX) / 2 + AROUND_PX;
    const at = Math.max(half, Math.min(width - half, x(time_s)));
    if (!labels.some((other) => Math.abs(at - other.at) < half + other.half)) labels.push({ kind, at, half });
  }
  return labels;
}

/** @typedef {{ from: number, to: number }} Span simulated seconds */

const LEAST_S = 5; // no shorter span is shown

/** The whole timeline of a run of this length. @param {number} end_s @returns {Span} */
export const whole = (end_s) => ({ from: 0, to: Math.max(60, end_s * 1.03) });

/**
 * A span by a factor longer (> 1) or shorter, in which `at` keeps its place; null: the whole.
 * @param {Span} span
 * @param {number} factor
 * @param {number} at
 * @param {Span} all
 * @returns {Span | null}
 */
export function zoomed(span, factor, at, all) {
  const length = Math.max(LEAST_S, (span.to - span.from) * factor);
  if (length >= all.to - all.from) return null;
  const share = (at - span.from) / (span.to - span.from);
  return within({ from: at - share * length, to: at + (1 - share) * length }, all);
}

/** The span moved into the whole. @param {Span} span @param {Span} all @returns {Span} */
export function within(span, all) {
  const length = span.to - span.from;
  const from = Math.min(Math.max(span.from, all.from), Math.max(all.from, all.to - length));
  return { from, to: from + length };
}

const STEPS_S = [10, 30, 60, 120, 180, 300, 600, 900, 1800, 3600, 7200, 14400];

const PER_TICK_PX = 110;

/** The times written below the part of a timeline from `from` to `to` that is `width` pixels wide. @param {number} from @param {number} to @param {number} width */
export function tickTimesIn(from, to, width) {
  if (from <= 0) return tickTimes(to, width);
  const most = Math.max(3, Math.floor(width / PER_TICK_PX));
  const step = [1, 2, 5, ...STEPS_S].find((value) => (to - from) / value <= most) ?? tickTimes(to - from, width)[1];
  const times = [];
  for (let time = Math.ceil(from / step) * step; time <= to; time += step) times.push(time);
  return times;
}

/** The times written below a timeline of `end` seconds that is `width` pixels wide. @param {number} end @param {number} width */
export function tickTimes(end, width) {
  const most = Math.max(3, Math.floor(width / PER_TICK_PX));
  const step = STEPS_S.find((value) => end / value <= most) ?? Math.ceil(end / most / 3600) * 3600;
  const times = [];
  for (let time = 0; time <= end - step * 0.2; time += step) times.push(time);
  return times;
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

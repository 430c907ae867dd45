// Which events have room on the timeline. No DOM.

import { clock } from "./clock.js";
import { nameOf, weightOf } from "./event_kinds.js";

const [LETTER_PX, AROUND_PX] = [7.2, 5]; // width of a letter, and room on either side of a name
const NAMED = 60; // of the events that count, this many of the newest get names
const APART_PX = 5; // a second mark of the same kind within this distance would say nothing

/** @typedef {(time_s: number) => number} Axis where a time is, pixels */

/** @param {TimelineEvent} event */
export const words = (event) => `${clock(event.time_s)} ${nameOf(event.kind)}: ${event.text}`;

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

// Which events have room on the timeline, which part of it is shown, and which event is next. No DOM.

import { clock } from "../ui/words.js";
import { nameOf, weightOf } from "./event_kinds.js";

const [LETTER_PX, AROUND_PX] = [7.2, 5]; // width of a letter, and room on either side of a name
const NAMED = 60; // of the events that count, this many of the newest get names
const APART_PX = 5; // a second mark of the same kind within this distance would say nothing

/** @typedef {(time_s: number) => number} Axis where a time is, pixels */

/** @param {TimelineEvent} event */
export const words = (event) => `${clock(event.time_s)} ${nameOf(event.kind)}: ${event.text}${times(event)}`;

/** How often what repeats has happened, "" for once. @param {Pick<TimelineEvent, "count" | "since_s">} event */
export const times = ({ count, since_s }) => (count > 1 ? `, ${count} times since ${clock(since_s)}` : "");

/** Of what repeats only the newest, which counts the others. @param {TimelineEvent[]} events oldest first */
export function counted(events) {
  const newest = new Map(events.map((event) => [event.line, event]));
  return events.filter((event) => !event.line || newest.get(event.line) === event);
}

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

/**
 * The time of the next event after a time (`way` 1) or before it (-1); undefined: there is none.
 * @param {TimelineEvent[]} events oldest first
 * @param {number} time_s
 * @param {1 | -1} way
 */
export function nextEvent(events, time_s, way) {
  const times = events.map((event) => event.time_s).filter((time) => (time - time_s) * way > 0.05);
  return way > 0 ? times[0] : times.at(-1);
}

/** A time for people, to the tenth. @param {number} seconds */
export const fine = (seconds) => `${clock(seconds)}.${Math.floor(seconds * 10 + 1e-6) % 10}`;

/**
 * When two branches parted: the first time that they do not share.
 * @param {BranchFields[]} branches
 * @param {number} a
 * @param {number} b
 */
export function parted(branches, a, b) {
  const lines = [a, b].map((number) => lineOf(branches, number));
  let same = 0;
  while (lines[0][same] && lines[0][same] === lines[1][same]) same++;
  return Math.min(...lines.map((line) => line[same]?.from_s ?? Infinity));
}

/** A branch and its forebears, the first of them first. @param {BranchFields[]} branches @param {number} number */
function lineOf(branches, number) {
  /** @type {BranchFields[]} */
  const line = [];
  for (
    let at = branches.find((one) => one.number === number);
    at;
    at = branches.find((one) => one.number === at?.parent)
  )
    line.unshift(at);
  return line;
}

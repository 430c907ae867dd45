// A plot against time as a vector picture: axes, lines and what they are. No DOM.

import { clock } from "../ui/words.js";
import { tickTimesIn } from "../timeline/line.js";

const [WIDE, HIGH, LEFT, RIGHT, TOP, BOTTOM] = [900, 420, 70, 24, 76, 58]; // pixels
const MOST = 1500; // points of a line

/** @typedef {{ label: string, colour: string, dash?: number[] }} DrawnLine `colour` as in CSS */
/** @typedef {{ paper: string, text: string, second: string, rim: string }} Inks */

/** @param {string} words */
const plain = (words) =>
  [...words].map((c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c] ?? (c >= " " ? c : "")).join("");

/** Round numbers, about `most` of them, from `low` to `high`. @param {number} low @param {number} high @param {number} most */
export function ticksIn(low, high, most = 6) {
  const rough = Math.max((high - low) / most, 1e-9);
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * ten).find((k) => k >= rough) ?? 10 * ten;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-6; k++)
    ticks.push(Number((k * step).toPrecision(12)));
  return ticks;
}

/** Ticks between which all lies: no line touches the upper edge. @param {number} low @param {number} high */
function roundTicks(low, high) {
  const ticks = ticksIn(low, high);
  const step = ticks.length > 1 ? ticks[1] - ticks[0] : high - low;
  const first = ticks[0] <= low ? [] : [Number((ticks[0] - step).toPrecision(12))];
  const last = /** @type {number} */ (ticks.at(-1));
  return [...first, ...ticks, ...(last >= high ? [] : [Number((last + step).toPrecision(12))])];
}

/**
 * @param {string} title
 * @param {string} moment of which run and moment it is
 * @param {ArrayLike<number>[]} columns the time first, seconds
 * @param {DrawnLine[]} lines
 * @param {Inks} inks
 */
export function plotSvg(title, moment, columns, lines, inks) {
  const [times, ...values] = columns.map((column) => Array.from(column));
  const known = values.flat().filter(Number.isFinite);
  const least = Math.min(0, ...extremes(known));
  const ticks = roundTicks(least, Math.max(least + 1e-9, ...extremes(known)));
  const [low, high] = [ticks[0], ticks.at(-1) ?? 1];
  const [from, to] = [times[0] ?? 0, Math.max(times.at(-1) ?? 1, (times[0] ?? 0) + 1e-9)];
  const x = (/** @type {number} */ s) => LEFT + ((WIDE - LEFT - RIGHT) * (s - from)) / (to - from);
  const y = (/** @type {number} */ v) => HIGH - BOTTOM - ((HIGH - TOP - BOTTOM) * (v - low)) / (high - low);
  const text = (/** @type {number} */ at, /** @type {number} */ up, /** @type {string} */ words, more = "") =>
    `<text x="${at.toFixed(1)}" y="${up.toFixed(1)}" fill="${inks.second}" font-size="14"${more}>${plain(words)}</text>`;
  const rule = (/** @type {string} */ d) => `<path d="${d}" fill="none" stroke="${inks.rim}"/>`;
  const across = ticks.map(
    (v) =>
      rule(`M${LEFT} ${y(v).toFixed(1)}H${WIDE - RIGHT}`) + text(LEFT - 10, y(v) + 5, String(v), ' text-anchor="end"'),
  );
  const along = tickTimesIn(from, to, WIDE - LEFT - RIGHT).map(
    (s) =>
      rule(`M${x(s).toFixed(1)} ${TOP}V${HIGH - BOTTOM}`) +
      text(x(s), HIGH - BOTTOM + 20, clock(s), ' text-anchor="middle"'),
  );
  const drawn = lines.map(({ label, colour, dash }, k) => {
    const at = LEFT + k * 200;
    const stroke = `fill="none" stroke="${plain(colour)}" stroke-width="2"${dash ? ` stroke-dasharray="${dash.join(" ")}"` : ""}`;
    const d = pathOf(times, values[k] ?? [], x, y);
    return `<path d="${d}" ${stroke} stroke-linejoin="round"/><path d="M${at} 56h26" ${stroke}/>${text(at + 34, 61, label)}`;
  });
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${WIDE}" height="${HIGH}" viewBox="0 0 ${WIDE} ${HIGH}" `,
    'font-family="DejaVu Sans, Segoe UI, Roboto, Helvetica, Arial, sans-serif">',
    `<rect width="100%" height="100%" fill="${inks.paper}"/>`,
    `<text x="${LEFT}" y="32" fill="${inks.text}" font-size="19" font-weight="700">${plain(title)}</text>`,
    text(LEFT, HIGH - 14, moment),
    ...across,
    ...along,
    text(WIDE - RIGHT, HIGH - 14, "time (min:s)", ' text-anchor="end"'),
    ...drawn,
    "</svg>\n",
  ].join("");
}

/** @param {number[]} values */
const extremes = (values) =>
  values
    .reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity])
    .filter(Number.isFinite);

/**
 * A line, broken where a value is missing.
 * @param {number[]} times @param {number[]} values
 * @param {(s: number) => number} x @param {(v: number) => number} y
 */
function pathOf(times, values, x, y) {
  const every = Math.max(1, Math.ceil(times.length / MOST));
  let d = "";
  let pen = "M";
  for (let k = 0; k < times.length; k += every) {
    if (Number.isFinite(values[k])) d += `${pen}${x(times[k]).toFixed(1)} ${y(values[k]).toFixed(1)}`;
    pen = Number.isFinite(values[k]) ? "L" : "M";
  }
  return d;
}

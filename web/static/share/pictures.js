// Pictures as files: vector pictures as they are, or drawn into pixels, and plots against time as vector pictures. Their names tell
// run and moment.

import { clock, toast } from "../ui/words.js";
import { tickTimesIn } from "../timeline/line.js";
import { make } from "../ui/elements.js";

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

/** @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  make("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

const SHARP = 2; // pixels of a PNG for each of the vector picture

/** The run and the moment that are shown: for names of files, and in words. */
export const shown = { name: "run", words: "" };

/** @param {string} svg @param {string} what */
export function saveSvg(svg, what) {
  const name = `${shown.name}-${what}.svg`;
  download(new Blob([svg], { type: "image/svg+xml" }), name);
  toast(`Saved ${name}.`);
}

/** @param {string} svg @param {string} what */
export async function savePng(svg, what) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  try {
    await image.decode();
  } catch {
    return toast("The picture could not be drawn.", { bad: true });
  }
  const canvas = make("canvas", { width: SHARP * image.naturalWidth, height: SHARP * image.naturalHeight });
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return saveCanvas(canvas, what);
}

/** @param {HTMLCanvasElement} canvas @param {string} what */
export async function saveCanvas(canvas, what) {
  /** @type {Blob | null} */
  const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!blob) return toast("The picture could not be made.", { bad: true });
  const name = `${shown.name}-${what}.png`;
  download(blob, name);
  return toast(`Saved ${name}.`);
}

/** @param {string} words */
const fileWord = (words) => words.toLowerCase().replace(/[^a-z0-9]+/g, "-");

/**
 * Two buttons that save a plot.
 * @param {string} words what it shows
 * @param {() => { columns: ArrayLike<number>[] | null, lines: import("../panel/truth.js").Line[] }} ask
 */
export function saveButtons(words, ask) {
  const property = (/** @type {string} */ name) =>
    getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const svg = () => {
    const { columns, lines } = ask();
    const drawn = lines.map(({ label, colour, dash }) => ({ label, dash, colour: property(colour) }));
    const inks = { paper: property("bar"), text: property("text"), second: property("second"), rim: property("rim") };
    return plotSvg(words, shown.words, columns ?? [[]], drawn, inks);
  };
  const button = (/** @type {string} */ kind, /** @type {() => unknown} */ save) => {
    const made = make("button", { type: "button", className: "tiny", textContent: kind, title: `Save as ${kind}` });
    made.setAttribute("aria-label", `${words}: save as ${kind}`);
    made.addEventListener("click", save);
    return made;
  };
  return make(
    "div",
    { className: "saving" },
    button("PNG", () => savePng(svg(), fileWord(words))),
    button("SVG", () => saveSvg(svg(), fileWord(words))),
  );
}

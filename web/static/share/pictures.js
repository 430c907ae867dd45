// Pictures as files: vector pictures as they are, or drawn into pixels. Their names tell run and moment.

import { make } from "../ui/elements.js";
import { download } from "./download.js";
import { plotSvg } from "../model/plot_svg.js";
import { toast } from "../ui/toasts.js";

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

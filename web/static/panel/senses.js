// Senses: what the robot sees and feels, what is active among its views, and the pose cells from above.

import { make, say } from "../ui/elements.js";
import { Bar, caption, colourOf, Histogram, mix, Picture } from "./parts.js";

/** @typedef {import("./parts.js").Rgb} Rgb */
/** @typedef {import("./parts.js").Pixels} Pixels */

export const STRIP = { rows: 6, columns: 34, square: 6 }; // squares of the local view cells, and pixels of one

/** How many views one square of the strip stands for. @param {number} views */
export const viewsASquare = (views) => Math.max(1, Math.ceil(views / (STRIP.rows * STRIP.columns)));

/**
 * A square for each view (or for several neighbours), lit while active and fading for a while after.
 * @param {{ views: number, active: number, recent: number[] }} cells `recent`: oldest first
 * @param {{ quiet: Rgb, lit: Rgb, active: Rgb, ground: Rgb }} colours
 * @returns {Pixels}
 */
export function viewStrip({ views, active, recent }, colours) {
  const { rows, columns, square } = STRIP;
  const [width, height, each] = [columns * square, rows * square, viewsASquare(views)];
  const rgba = new Uint8ClampedArray(4 * width * height);
  /** @param {number} number @param {Rgb} colour @param {number} opacity */
  const fill = (number, [red, green, blue], opacity) => {
    const [left, top] = [(number % columns) * square, Math.floor(number / columns) * square];
    for (let y = top; y < top + square - 1; y++)
      for (let x = left; x < left + square - 1; x++) rgba.set([red, green, blue, opacity], 4 * (y * width + x));
  };
  const last = rows * columns - 1;
  for (let k = 0; k <= last; k++) fill(k, colours.quiet, k < Math.ceil(views / each) ? 60 : 18);
  const faint = mix(colours.ground, colours.quiet, 0.3);
  recent.forEach((view, k) => {
    fill(Math.min(Math.floor(view / each), last), mix(faint, colours.lit, (k + 1) / (recent.length + 1)), 255);
  });
  if (active >= 0) fill(Math.min(Math.floor(active / each), last), colours.active, 255);
  return { width, height, rgba };
}

/** @type {Record<string, number>} */
const STEPS = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: STRIP.columns, ArrowUp: -STRIP.columns };

/** The local view cells as a strip of squares. A click on a square inspects its first view, and the keys do the same. */
class ViewStrip {
  /** @param {(wish: Record<string, number>) => void} inspect */
  constructor(inspect) {
    this.inspect = inspect;
    this.picture = new Picture("the local view cells");
    this.picture.canvas.setAttribute("aria-hidden", "true");
    this.cursor = make("span", { className: "cursor" });
    this.box = make("div", { className: "view-strip", tabIndex: 0 }, this.picture.canvas, this.cursor);
    this.box.setAttribute("role", "slider");
    this.box.setAttribute("aria-label", "Local view cells: arrow keys choose one, Enter inspects it");
    this.views = this.square = 0;
    this.box.addEventListener("click", (event) => this.clicked(event));
    this.box.addEventListener("keydown", (event) => this.pressed(event));
    this.move(0);
  }

  /** @param {{ views: number, active: number, recent: number[] }} cells */
  show(cells) {
    this.views = cells.views;
    const colours = { quiet: "second", lit: "packet-1", active: "robot", ground: "bar" };
    const of = Object.fromEntries(Object.entries(colours).map(([name, property]) => [name, colourOf(property)]));
    this.picture.draw(viewStrip(cells, /** @type {any} */ (of)));
    this.move(this.square);
  }

  /** @param {MouseEvent} event */
  clicked({ clientX, clientY }) {
    const { left, top, width, height } = this.picture.canvas.getBoundingClientRect();
    const row = Math.floor(((clientY - top) / height) * STRIP.rows);
    this.choose(row * STRIP.columns + Math.floor(((clientX - left) / width) * STRIP.columns));
  }

  /** @param {KeyboardEvent} event */
  pressed(event) {
    const squares = Math.ceil(this.views / viewsASquare(this.views));
    if (event.key in STEPS) this.move(Math.min(Math.max(this.square + STEPS[event.key], 0), Math.max(squares - 1, 0)));
    else if (event.key === "Enter") this.choose(this.square);
    else return;
    event.preventDefault();
  }

  /** @param {number} square */
  choose(square) {
    this.move(square);
    const view = square * viewsASquare(this.views);
    if (view < this.views) this.inspect({ view });
  }

  /** @param {number} square */
  move(square) {
    this.square = square;
    const view = square * viewsASquare(this.views);
    this.cursor.style.left = `${(100 * (square % STRIP.columns)) / STRIP.columns}%`;
    this.cursor.style.top = `${(100 * Math.floor(square / STRIP.columns)) / STRIP.rows}%`;
    for (const [name, value] of Object.entries({ valuemin: 0, valuemax: Math.max(this.views - 1, 0), valuenow: view }))
      this.box.setAttribute(`aria-${name}`, String(value));
    this.box.setAttribute("aria-valuetext", `view ${view} of ${this.views}`);
  }
}

const PACKETS = ["packet-1", "packet-2", "packet-3", "packet-4"];

/** @typedef {Record<string, import("../net/connection.js").Parcel>} Arrays */

export class SensesTab {
  /** @param {(wish: Record<string, number>) => void} inspect */
  constructor(inspect) {
    this.camera = new Picture("what the robot's camera sees");
    this.seen = new Picture("the present view, as it is compared");
    this.best = new Picture("the best match");
    this.above = new Picture("pose cells seen from above, x′ to the right");
    this.seenTitle = caption("");
    this.bestTitle = caption("best match");
    this.difference = caption("");
    this.cells = caption("");
    this.number = make("p", { className: "number" });
    this.words = make("span");
    this.verdict = make("p", { className: "verdict" }, make("i"), this.words);
    this.view = -1;
    this.match = make("button", { type: "button", className: "picture", hidden: true }, this.best.canvas);
    this.match.addEventListener("click", () => inspect({ view: this.view }));
    this.none = make("p", { className: "blank", textContent: "none yet: every view is new" });
    this.noCamera = make("p", { className: "blank", textContent: "no camera, or it is off", hidden: true });
    this.bar = new Bar(0.5);
    this.strip = new ViewStrip(inspect);
    this.turns = new Histogram("activity by heading");
    this.box = make(
      "div",
      {},
      row([caption("camera"), this.camera.canvas, this.noCamera], [caption("active view"), this.number, this.verdict]),
      row([this.seenTitle, this.seen.canvas], [this.bestTitle, this.match, this.none]),
      this.difference,
      this.bar.box,
      this.cells,
      this.strip.box,
      row([caption("pose cells from above"), this.above.canvas], [caption("by heading θ′"), this.turns.box]),
    );
  }

  /** @param {any} data @param {Arrays} arrays */
  views(data, arrays) {
    this.camera.show(arrays.camera);
    this.noCamera.hidden = !this.camera.canvas.hidden;
    say(this.number, data.active >= 0 ? `#${data.active}` : "none");
    say(this.words, data.verdict.words);
    this.verdict.dataset.tone = data.verdict.tone;
    say(this.seenTitle, data.seen.title);
    this.seen.says(data.seen.words).show(arrays.seen);
    this.match.hidden = data.best === null;
    this.none.hidden = data.best !== null;
    say(this.bestTitle, data.best ? `best match #${data.best.view}` : "best match");
    if (data.best) {
      this.view = data.best.view;
      this.match.setAttribute("aria-label", `Inspect ${data.best.words}`);
      this.best.says(data.best.words).show(arrays.best);
    }
    const { active, known, recent } = data;
    say(this.cells, `local view cells (${active >= 0 ? `active #${active}` : "none active"} of ${known})`);
    this.strip.show({ active, views: known, recent });
    say(this.difference, data.difference.words);
    this.bar.show(data.difference.share, data.difference.known ? "known" : "new");
  }

  /** @param {any} data @param {Arrays} arrays */
  poseCells(data, arrays) {
    const [places, packets, strength] = [arrays.places, arrays.packets, arrays.strength].map(({ values }) => values);
    this.above.draw(fromAbove(data.size, places, packets, strength, PACKETS.map(colourOf), colourOf("second")));
    this.turns.show(arrays.by_heading.values);
  }

  /** What to do with each part, by its name. */
  get parts() {
    return { views: this.views.bind(this), cells: this.poseCells.bind(this) };
  }
}

/** Two columns of equal width. @param {Node[]} left @param {Node[]} right */
function row(left, right) {
  return make("div", { className: "pair" }, make("div", {}, ...left), make("div", {}, ...right));
}

/**
 * Pose cells from above, the front row at the bottom: each column of cells in the colours of its packets.
 * @param {[number, number]} size rows (y′) and columns (x′)
 * @param {ArrayLike<number>} places y′ n_x + x′ of each entry
 * @param {ArrayLike<number>} packets the rank of its packet
 * @param {ArrayLike<number>} strength its activity, in any unit
 * @param {Rgb[]} colours of the packets by rank; higher ranks have the last one
 * @param {Rgb} ground where nothing is active
 * @returns {Pixels}
 */
export function fromAbove([height, width], places, packets, strength, colours, ground) {
  const sums = new Float64Array(4 * width * height); // red, green and blue weighted with the activity, then the sum of the activity
  for (let k = 0; k < places.length; k++) {
    const colour = colours[Math.min(packets[k], colours.length - 1)];
    for (let c = 0; c < 3; c++) sums[4 * places[k] + c] += colour[c] * strength[k];
    sums[4 * places[k] + 3] += strength[k];
  }
  let most = 1e-12;
  for (let k = 3; k < sums.length; k += 4) most = Math.max(most, sums[k]);
  const rgba = new Uint8ClampedArray(4 * width * height);
  for (let k = 0; k < width * height; k++) {
    const weight = sums[4 * k + 3];
    const at = 4 * ((height - 1 - Math.floor(k / width)) * width + (k % width));
    for (let c = 0; c < 3; c++) rgba[at + c] = weight > 0 ? sums[4 * k + c] / weight : ground[c];
    rgba[at + 3] = 28 + Math.sqrt(weight / most) * (255 - 28);
  }
  return { width, height, rgba };
}

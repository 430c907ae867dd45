// The local view cells as a strip of squares. A click on a square inspects its first view, and the keys do the same.

import { make } from "../ui/elements.js";
import { STRIP, viewsASquare, viewStrip } from "../model/pixels.js";
import { colourOf, Picture } from "./canvases.js";

/** @type {Record<string, number>} */
const STEPS = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: STRIP.columns, ArrowUp: -STRIP.columns };

export class ViewStrip {
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

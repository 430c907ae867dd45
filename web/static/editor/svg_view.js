// A sheet in metres, drawn as SVG: which part of it is visible, layers, lines and circles, and its grid.

import { svg } from "../ui/elements.js";
import { ViewBox } from "../model/view_box.js";

// Subclasses define `draw()` and `ring`, the corners of everything on it.
export class SvgView {
  grid = 0.25; // metres from line to line

  /** @param {SVGSVGElement} place @param {readonly string[]} layers */
  constructor(place, layers) {
    this.place = place;
    this.layers = Object.fromEntries(layers.map((name) => [name, svg("g", { class: name })]));
    place.append(...Object.values(this.layers));
    this.view = new ViewBox();
    this.moved = false; // by hand; until then, a plan of another size is shown as a whole, too
    new ResizeObserver(() => this.resized()).observe(place);
  }

  /** @returns {Point[] | undefined} */
  get ring() {
    return undefined;
  }

  get scale() {
    return this.view.scale;
  }

  draw() {}

  resized() {
    if (!this.ring || !this.place.clientWidth) return;
    if (this.moved) this.draw();
    else this.fit();
  }

  // The whole outline on the plan.
  fit() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !this.ring) return;
    this.moved = false;
    this.view.fit(this.ring, width, height);
    this.draw();
  }

  /** @param {number} dx @param {number} dy */
  pan(dx, dy) {
    this.moved = true;
    this.view.pan(dx, dy);
    this.draw();
  }

  /** Enlarge by `factor`; the pixel `around` stays where it is. @param {number} factor @param {Point} [around] */
  zoom(factor, around = [this.place.clientWidth / 2, this.place.clientHeight / 2]) {
    this.moved = true;
    this.view.zoom(factor, around);
    this.draw();
  }

  /** @param {Point} p */
  pixel(p) {
    return this.view.pixel(p);
  }

  /** @param {Point} pixel */
  metres(pixel) {
    return this.view.metres(pixel);
  }

  /** Bring a point into sight. @param {Point} p */
  reveal(p) {
    const [dx, dy] = this.view.push(p, this.place.clientWidth, this.place.clientHeight);
    if (dx || dy) this.pan(dx, dy);
  }

  // ---------------------------------------------------------------- drawing

  /** @param {string} layer @param {Element[]} parts */
  fill(layer, parts) {
    this.layers[layer].replaceChildren(...parts);
  }

  /** @param {string} kind @param {Point[]} points */
  path(kind, points, closed = false, title = "") {
    const d = `M${points
      .map((p) =>
        this.pixel(p)
          .map((u) => u.toFixed(1))
          .join(" "),
      )
      .join("L")}${closed ? "Z" : ""}`;
    const made = svg("path", { d, class: kind });
    if (title) made.append(svg("title", {}, title));
    return made;
  }

  /** @param {string} kind @param {Point} p @param {number} r */
  circle(kind, p, r, title = "") {
    const [cx, cy] = this.pixel(p);
    const made = svg("circle", { cx, cy, r, class: kind });
    if (title) made.append(svg("title", {}, title));
    return made;
  }

  /** @param {string} kind @param {Point} p @param {string} words */
  text(kind, p, words, dy = -10) {
    const [x, y] = this.pixel(p);
    return svg("text", { x, y: y + dy, class: kind, "text-anchor": "middle" }, words);
  }

  drawGrid() {
    const { clientWidth: width, clientHeight: height } = this.place;
    const { fine, coarse } = this.view.gridSteps(this.grid);
    const lines = (/** @type {number} */ every) => {
      const [x0, y1] = this.metres([0, 0]);
      const [x1, y0] = this.metres([width, height]);
      let d = "";
      for (let k = Math.ceil(x0 / every); k * every <= x1; k++)
        d += `M${this.pixel([k * every, 0])[0].toFixed(1)} 0V${height}`;
      for (let k = Math.ceil(y0 / every); k * every <= y1; k++)
        d += `M0 ${this.pixel([0, k * every])[1].toFixed(1)}H${width}`;
      return d;
    };
    this.fill("grid", [
      svg("path", { d: lines(fine), class: "fine" }),
      svg("path", { d: lines(coarse), class: "coarse" }),
    ]);
  }
}

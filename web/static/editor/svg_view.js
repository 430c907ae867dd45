// A sheet in metres, drawn as SVG: which part of it is visible, layers, lines and circles, and its grid.

import { svg } from "../ui/elements.js";

const MARGIN_PX = 36;
const EDGE_PX = 24; // a point nearer to the edge of the sheet counts as out of sight
const LEAST_GRID_PX = 7;
const [LEAST, MOST] = [0.1, 2000]; // pixels per metre

export class ViewBox {
  scale = 0; // pixels per metre; 0: not shown yet
  /** @type {Point} */
  origin = [0, 0]; // where (0, 0) is on the sheet, pixels

  /** Shows all of these points on a sheet of this size. @param {Point[]} ring @param {number} width @param {number} height */
  fit(ring, width, height) {
    const [xs, ys] = [ring.map((p) => p[0]), ring.map((p) => p[1])];
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const [free, high] = [width - 2 * MARGIN_PX, height - 2 * MARGIN_PX];
    this.scale = within(Math.min(free / (x1 - x0), high / (y1 - y0)));
    this.origin = [width / 2 - (this.scale * (x0 + x1)) / 2, height / 2 + (this.scale * (y0 + y1)) / 2];
  }

  /** @param {number} dx @param {number} dy pixels */
  pan(dx, dy) {
    this.origin = [this.origin[0] + dx, this.origin[1] + dy];
  }

  /** Enlarges by `factor`; the pixel `around` stays where it is. @param {number} factor @param {Point} around */
  zoom(factor, around) {
    const to = within(this.scale * factor);
    const moved = (/** @type {0 | 1} */ k) => around[k] + ((this.origin[k] - around[k]) * to) / this.scale;
    this.origin = [moved(0), moved(1)];
    this.scale = to;
  }

  /** @param {Point} p @returns {Point} */
  pixel([x, y]) {
    return [this.origin[0] + x * this.scale, this.origin[1] - y * this.scale];
  }

  /** @param {Point} pixel @returns {Point} */
  metres([u, v]) {
    return [(u - this.origin[0]) / this.scale, (this.origin[1] - v) / this.scale];
  }

  /** By how many pixels the sheet must be moved until a point is in sight. @param {Point} p @param {number} width @param {number} height @returns {Point} */
  push(p, width, height) {
    const [u, v] = this.pixel(p);
    const by = (/** @type {number} */ at, /** @type {number} */ size) =>
      at < EDGE_PX ? EDGE_PX - at : Math.min(0, size - EDGE_PX - at);
    return [by(u, width), by(v, height)];
  }

  /** The steps of a grid's fine and coarse lines, metres: as asked for, or wider if the lines would be too dense. @param {number} asked */
  gridSteps(asked) {
    let step = asked;
    while (step * this.scale < LEAST_GRID_PX) step *= step < 1 && step * 4 >= 1 ? 1 / step : 5;
    return { fine: step, coarse: step < 1 ? 1 : step * 5 };
  }
}

/** @param {number} scale */
const within = (scale) => Math.max(LEAST, Math.min(MOST, scale));

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

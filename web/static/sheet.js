// A sheet of paper in metres, drawn as SVG: what part of it is seen, layers, lines and circles, and its grid.

import { svg } from "./icons.js";

const LEAST_GRID_PX = 7;
const [LEAST, MOST] = [0.1, 2000]; // pixels a metre

// `draw()` and `ring`, the corners of all that is on it, are the heir's.
export class Sheet {
  constructor(place, layers) {
    this.place = place;
    this.layers = Object.fromEntries(layers.map((name) => [name, svg("g", { class: name })]));
    place.append(...Object.values(this.layers));
    this.scale = 0; // pixels a metre; 0: not shown yet
    this.origin = [0, 0]; // where (0, 0) is on the sheet, pixels
    new ResizeObserver(() => this.resized()).observe(place);
  }

  resized() {
    if (!this.ring || !this.place.clientWidth) return;
    if (this.moved) this.draw();
    else this.fit();
  }

  // The whole outline on the plan.
  fit() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !this.ring) return;
    this.moved = false; // by hand: until then a plan of another size shows all of it, too
    const [xs, ys] = [this.ring.map((p) => p[0]), this.ring.map((p) => p[1])];
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    this.scale = Math.max(LEAST, Math.min(MOST, Math.min((width - 72) / (x1 - x0), (height - 72) / (y1 - y0))));
    this.origin = [width / 2 - (this.scale * (x0 + x1)) / 2, height / 2 + (this.scale * (y0 + y1)) / 2];
    this.draw();
  }

  pan(dx, dy) {
    this.moved = true;
    this.origin = [this.origin[0] + dx, this.origin[1] + dy];
    this.draw();
  }

  // Larger by `factor`; the pixel `around` stays where it is.
  zoom(factor, around = [this.place.clientWidth / 2, this.place.clientHeight / 2]) {
    const to = Math.max(LEAST, Math.min(MOST, this.scale * factor));
    this.moved = true;
    this.origin = this.origin.map((o, k) => around[k] + ((o - around[k]) * to) / this.scale);
    this.scale = to;
    this.draw();
  }

  pixel([x, y]) {
    return [this.origin[0] + x * this.scale, this.origin[1] - y * this.scale];
  }

  metres([u, v]) {
    return [(u - this.origin[0]) / this.scale, (this.origin[1] - v) / this.scale];
  }

  // Bring a point into sight.
  reveal(p) {
    const [u, v] = this.pixel(p);
    const { clientWidth: width, clientHeight: height } = this.place;
    const push = (at, size) => (at < 24 ? 24 - at : at > size - 24 ? size - 24 - at : 0);
    if (push(u, width) || push(v, height)) this.pan(push(u, width), push(v, height));
  }

  // ---------------------------------------------------------------- drawing

  fill(layer, parts) {
    this.layers[layer].replaceChildren(...parts);
  }

  path(kind, points, closed = false, title = "") {
    const d = `M${points.map((p) => this.pixel(p).map((u) => u.toFixed(1)).join(" ")).join("L")}${closed ? "Z" : ""}`;
    const made = svg("path", { d, class: kind });
    if (title) made.append(svg("title", {}, title));
    return made;
  }

  circle(kind, p, r, title = "") {
    const [cx, cy] = this.pixel(p);
    const made = svg("circle", { cx, cy, r, class: kind });
    if (title) made.append(svg("title", {}, title));
    return made;
  }

  text(kind, p, words, dy = -10) {
    const [x, y] = this.pixel(p);
    return svg("text", { x, y: y + dy, class: kind, "text-anchor": "middle" }, words);
  }

  drawGrid() {
    const { clientWidth: width, clientHeight: height } = this.place;
    let step = this.grid || 0.25;
    while (step * this.scale < LEAST_GRID_PX) step *= step < 1 && step * 4 >= 1 ? 1 / step : 5;
    const lines = (every) => {
      const [x0, y1] = this.metres([0, 0]);
      const [x1, y0] = this.metres([width, height]);
      let d = "";
      for (let k = Math.ceil(x0 / every); k * every <= x1; k++) d += `M${this.pixel([k * every, 0])[0].toFixed(1)} 0V${height}`;
      for (let k = Math.ceil(y0 / every); k * every <= y1; k++) d += `M0 ${this.pixel([0, k * every])[1].toFixed(1)}H${width}`;
      return d;
    };
    const coarse = step < 1 ? 1 : step * 5;
    this.fill("grid", [svg("path", { d: lines(step), class: "fine" }), svg("path", { d: lines(coarse), class: "coarse" })]);
  }
}

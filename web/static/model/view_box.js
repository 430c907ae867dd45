// Which part of the office is visible on a sheet, and where: metres to pixels and back. No DOM.

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

// The daylight against time as a curve in a small picture. No DOM.

export const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [316, 112, 26, 8, 8, 20]; // of the picture, and margins around its axes
const LEAST_S = 60;

export class DaylightCurve {
  /** @param {DaylightItem | null} day */
  constructor(day) {
    this.points = day?.points ?? [];
    this.repeat_s = day?.repeat_s ?? 0;
    this.span_s = this.repeat_s || Math.max(LEAST_S, (this.points.at(-1)?.[0] ?? 0) * 1.25);
    this.most = Math.max(1.2, ...this.points.map(([, level]) => level * 1.1));
  }

  /** @param {number} at_s */
  x(at_s) {
    return LEFT + ((WIDTH - LEFT - RIGHT) * Math.min(at_s, this.span_s)) / this.span_s;
  }

  /** @param {number} level */
  y(level) {
    return HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * Math.min(level, this.most)) / this.most;
  }

  /** Where a moment is in the picture; if the curve repeats, within its period. @param {number} now_s */
  now(now_s) {
    return this.x(this.repeat_s ? now_s % this.repeat_s : now_s);
  }

  /** The curve as a path: level before the first point and after the last. */
  get path() {
    const [first, last] = [this.points[0]?.[1] ?? 1, this.points.at(-1)?.[1] ?? 1];
    const curve = [[0, first], ...this.points, [this.span_s, last]].filter(([at_s]) => at_s <= this.span_s);
    return `M${curve.map(([at_s, level]) => `${this.x(at_s).toFixed(1)} ${this.y(level).toFixed(1)}`).join("L")}`;
  }
}

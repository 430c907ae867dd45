// The walls of the plan. A few are SVG like everything else. Thousands are painted once on a canvas beneath, since the browser
// paints all of the SVG again whenever the robot moves, which takes seconds for ten thousand walls without a graphics card.

import { svg } from "../ui/elements.js";
import { looksOf } from "../model/walls.js";

/** @typedef {ReturnType<typeof looksOf>} Looks */
/** @typedef {(p: Point) => Point} Pixel from metres to pixels of the plan */

const MANY = 1000;
const AT_ONCE = 100; // lines in one stroke: the more there are, the longer each takes
/** @type {Record<Looks, [colour: string, width: number, dashes: number[]]>} */
const LOOKS = {
  outer: ["--outer", 4, []],
  wall: ["--wall", 3, []],
  low: ["--low", 2.5, []],
  high: ["--low", 1.5, [3, 4]],
  glass: ["--glass", 3, [8, 5]],
};

export class Walls {
  /**
   * @param {SVGSVGElement} place
   * @param {Element} layer
   * @param {Element} grid the layer of the plan's grid, which has to lie beneath the walls wherever they are
   */
  constructor(place, layer, grid) {
    this.place = place;
    this.layer = layer;
    this.grid = grid;
    /** @type {(() => void) | null} */
    this.again = null;
    this.canvas = document.createElement("canvas");
    this.canvas.className = "painted";
    place.before(this.canvas);
    this.paper = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d", { willReadFrequently: true })); // kept in memory: quicker without a graphics card
    new MutationObserver(() => this.again?.()).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  }

  /** @param {Wall[]} walls @param {Pixel} pixel */
  draw(walls, pixel) {
    const many = walls.length > MANY;
    this.canvas.hidden = !many;
    /** @type {[string, string][]} */
    const lines = [...(many ? this.grid.children : [])].map((path) => [
      path.getAttribute("class") ?? "",
      path.getAttribute("d") ?? "",
    ]);
    if (many) this.grid.replaceChildren();
    this.again = many ? () => this.paint(walls, pixel, lines) : null;
    this.again?.();
    if (many) return this.layer.replaceChildren();
    const paths = new Map();
    for (const wall of walls) {
      const [[a, b], [c, d]] = [pixel(wall.from), pixel(wall.to)];
      paths.set(
        looksOf(wall),
        `${paths.get(looksOf(wall)) ?? ""}M${a.toFixed(1)} ${b.toFixed(1)}L${c.toFixed(1)} ${d.toFixed(1)}`,
      );
    }
    this.layer.replaceChildren(...[...paths].map(([kind, d]) => svg("path", { d, class: kind })));
  }

  /** Paint the walls in sight. @param {Wall[]} walls @param {Pixel} pixel @param {[kind: string, d: string][]} grid */
  paint(walls, pixel, grid) {
    const { clientWidth: width, clientHeight: height } = this.place;
    const [{ paper, canvas }, sharp, style] = [this, window.devicePixelRatio || 1, getComputedStyle(this.place)];
    [canvas.width, canvas.height] = [Math.round(width * sharp), Math.round(height * sharp)];
    paper.scale(sharp, sharp);
    for (const [kind, d] of grid) {
      paper.strokeStyle = style.getPropertyValue(kind === "fine" ? "--grid" : "--coarse");
      paper.stroke(new Path2D(d));
    }
    paper.lineCap = "round";
    const kinds = /** @type {Looks[]} */ (Object.keys(LOOKS));
    /** @type {Record<Looks, number[]>} */
    const begun = { outer: [], wall: [], low: [], high: [], glass: [] };
    for (const wall of walls) {
      const [[a, b], [c, d]] = [pixel(wall.from), pixel(wall.to)];
      if (Math.max(a, c) < -9 || Math.min(a, c) > width + 9 || Math.max(b, d) < -9 || Math.min(b, d) > height + 9)
        continue;
      const lines = begun[looksOf(wall)];
      lines.push(a, b, c, d);
      if (lines.length >= 4 * AT_ONCE) this.stroke(looksOf(wall), lines.splice(0), style);
    }
    for (const kind of kinds) this.stroke(kind, begun[kind], style);
  }

  /** @param {Looks} kind @param {number[]} lines @param {CSSStyleDeclaration} style */
  stroke(kind, lines, style) {
    const [colour, width, dashes] = LOOKS[kind];
    const { paper } = this;
    [paper.strokeStyle, paper.lineWidth] = [style.getPropertyValue(colour), width];
    paper.setLineDash(dashes);
    paper.beginPath();
    for (let k = 0; k < lines.length; k += 4) {
      paper.moveTo(lines[k], lines[k + 1]);
      paper.lineTo(lines[k + 2], lines[k + 3]);
    }
    paper.stroke();
  }
}

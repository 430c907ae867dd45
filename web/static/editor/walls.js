// The walls of the plan, and how they change because something else has changed: corners stay closed, a door gets its gap. A few are
// SVG like everything else. Thousands are painted once on a canvas beneath, since the browser paints all of the SVG again whenever the
// robot moves, which takes seconds for ten thousand walls without a graphics card.

import { at, away, length, round, toSegment } from "./geometry.js";
import { svg } from "../ui/elements.js";

const JOINED_M = 1e-6; // ends nearer than this are one corner
const ON_THE_WALL_M = 0.03;
const LEAST_PART_M = 0.02;

/** A wall whose length has changed, with the panels that still fit on it. @param {Wall} wall @returns {Wall} */
export function fitted(wall) {
  if (!wall.panels) return wall;
  const panels = wall.panels.filter((panel) => panel.at + panel.width <= length(wall) + 1e-9);
  return { ...wall, panels };
}

/**
 * The steps that move the ends of walls along with `moves` ([from, to] points), so that corners stay closed.
 * @param {Pick<World, "walls">} world
 * @param {[Point, Point][]} moves
 * @param {number[]} [except] walls that are moved already
 * @returns {EditStep[]}
 */
export function pulledEnds(world, moves, except = []) {
  /** @type {EditStep[]} */
  const steps = [];
  world.walls.forEach((wall, number) => {
    if (except.includes(number)) return;
    let item = wall;
    for (const [from, to] of moves) {
      if (away(wall.from, from) < JOINED_M) item = { ...item, from: to };
      if (away(wall.to, from) < JOINED_M) item = { ...item, to };
    }
    if (item !== wall) steps.push({ do: "change", list: "walls", number, item: fitted(item) });
  });
  return steps;
}

/**
 * A door on an inner wall needs a gap: the wall is replaced by its parts on both sides of the leaf.
 * @param {Pick<World, "walls">} world
 * @param {Point} from
 * @param {Point} to
 * @returns {EditStep[]}
 */
export function gapSteps(world, from, to) {
  const on = (/** @type {Wall} */ wall) =>
    [from, to].every((p) => toSegment(p, wall.from, wall.to) < ON_THE_WALL_M) && !wall.outer && !wall.bottom;
  const number = world.walls.findIndex(on);
  if (number < 0) return [];
  const wall = world.walls[number];
  const [near, far] = [away(wall.from, from), away(wall.from, to)].sort((a, b) => a - b);
  /** @type {[number, number][]} */
  const sides = [
    [0, near],
    [far, length(wall)],
  ];
  const parts = sides
    .filter(([begin, end]) => end - begin > LEAST_PART_M)
    .map(([begin, end]) => part(wall, begin, end));
  /** @type {EditStep[]} */
  const steps = parts.map((item, k) =>
    k ? { do: "add", list: "walls", item } : { do: "change", list: "walls", number, item },
  );
  return steps.length ? steps : [{ do: "delete", list: "walls", number }];
}

/**
 * The part of a wall from one distance along it to another, with the panels that are wholly on that part.
 * @param {Wall} wall
 * @param {number} begin
 * @param {number} end
 * @returns {Wall}
 */
function part(wall, begin, end) {
  const whole = length(wall);
  const along = (/** @type {number} */ metres) => {
    const share = metres / whole;
    return at(wall.from[0] + (wall.to[0] - wall.from[0]) * share, wall.from[1] + (wall.to[1] - wall.from[1]) * share);
  };
  const item = { ...wall, from: begin === 0 ? wall.from : along(begin), to: end === whole ? wall.to : along(end) };
  if (!wall.panels) return item;
  const kept = wall.panels.filter((panel) => panel.at >= begin - 1e-9 && panel.at + panel.width <= end + 1e-9);
  return fitted({ ...item, panels: kept.map((panel) => ({ ...panel, at: round(Math.max(0, panel.at - begin)) })) });
}

/** How a wall is drawn on the plan. @param {Wall} wall @returns {"outer" | "high" | "glass" | "wall" | "low"} */
export function looksOf(wall) {
  if (wall.outer) return "outer";
  if (wall.bottom) return "high";
  return wall.kind === "glass" || wall.kind === "wall" ? wall.kind : "low";
}

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

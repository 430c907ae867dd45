// A small plan on which the class draws where it will end: by a click, or by arrow keys and Enter.

import { svg } from "../ui/elements.js";
import { outline, turned } from "../model/lessons.js";

const STEP = 0.02; // of the plan's width, an arrow key
/** @type {Record<string, Point>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @typedef {{ name: string, at: Point, words: string, heading?: number }} Pin where something is; its name is its look */
/** @typedef {{ lines: [Point, Point][], dots: Point[], turn: number }} Drawing m, and the angle by which it is turned for the eye */

export class Plan {
  /** @param {(at: Point) => void} draw called with metres when somebody draws a point */
  constructor(draw) {
    this.draw = draw;
    this.open = false;
    this.frame = outline([]);
    this.turn = 0;
    /** @type {Point} */
    this.cross = [0, 0]; // where the arrow keys are, turned
    this.walls = svg("path", { class: "walls" });
    this.dots = svg("path", { class: "places" });
    this.pins = svg("g");
    this.upright = svg("g", {}, this.walls, this.dots, this.pins);
    this.box = svg("svg", { class: "lesson-plan", role: "application" }, this.upright);
    this.box.addEventListener("click", (event) => this.click(event));
    this.box.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {Drawing} drawing walls of the office, or links and places of the map */
  show({ lines, dots, turn }) {
    const at = (/** @type {Point} */ point) => turned(point, turn);
    const ends = [...lines, ...dots.map((dot) => /** @type {[Point, Point]} */ ([dot, dot]))];
    this.frame = outline(ends.map(([a, b]) => [at(a), at(b)]));
    this.turn = turn;
    const { left, bottom, width, height } = this.frame;
    this.cross = [left + width / 2, bottom + height / 2];
    this.box.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.upright.setAttribute(
      "transform",
      `translate(${-left} ${bottom + height}) scale(1 -1) rotate(${(turn * 180) / Math.PI})`,
    );
    this.walls.setAttribute("d", outline(lines).d);
    this.dots.setAttribute("d", outline(dots.map((dot) => [dot, dot])).d);
  }

  /** @param {boolean} open whether a point can be drawn @param {string} words @param {Pin[]} pins @param {Point[]} votes */
  mark(open, words, pins, votes) {
    this.open = open;
    this.box.setAttribute("aria-label", words);
    this.box.classList.toggle("open", open);
    if (open) this.box.setAttribute("tabindex", "0");
    else this.box.removeAttribute("tabindex");
    this.box.setAttribute("role", open ? "application" : "img");
    const r = Math.max(this.frame.width, this.frame.height) / 45;
    const dots = votes.map(([x, y]) => svg("circle", { cx: x, cy: y, r: r * 0.6, class: "vote" }));
    const marks = pins.flatMap(({ name, at: [x, y], words, heading }) => [
      ...(heading === undefined ? [] : [svg("path", { d: ahead([x, y], heading, r), class: name })]),
      svg("circle", { cx: x, cy: y, r, class: name }, svg("title", {}, words)),
    ]);
    const said = pins.find(({ name }) => name === "said");
    const was = pins.find(({ name }) => name === "was");
    const apart = said && was ? [svg("path", { d: `M${said.at}L${was.at}`, class: "apart" })] : [];
    const focused = document.activeElement === this.box && open;
    const cross = focused ? [this.crossed(r)] : [];
    this.pins.replaceChildren(...apart, ...dots, ...marks, ...cross);
  }

  /** @param {MouseEvent} event */
  click({ clientX, clientY }) {
    const to = this.open && this.upright.getScreenCTM()?.inverse();
    if (!to) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(to);
    this.cross = turned([x, y], this.turn);
    this.draw([x, y]);
  }

  /** The cross of the arrow keys, which stands upright however the plan is turned. @param {number} r */
  crossed(r) {
    const [x, y] = turned(this.cross, -this.turn);
    const d = `M${x - 2 * r} ${y}h${4 * r}M${x} ${y - 2 * r}v${4 * r}`;
    return svg("path", { d, class: "cross", transform: `rotate(${(-this.turn * 180) / Math.PI} ${x} ${y})` });
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = ARROWS[event.key];
    if (!this.open || (!step && event.key !== "Enter" && event.key !== " ")) return;
    event.preventDefault();
    if (!step) return this.draw(turned(this.cross, -this.turn));
    const { left, bottom, width, height } = this.frame;
    const [x, y] = this.cross;
    const by = STEP * Math.max(width, height);
    this.cross = [
      Math.min(left + width, Math.max(left, x + step[0] * by)),
      Math.min(bottom + height, Math.max(bottom, y + step[1] * by)),
    ];
    const old = this.pins.querySelector(".cross");
    const made = this.crossed(Math.max(width, height) / 45);
    old?.remove();
    this.pins.append(made);
  }
}

/** Where it looks. @param {Point} at @param {number} heading @param {number} r */
const ahead = ([x, y], heading, r) => `M${x} ${y}l${2.2 * r * Math.cos(heading)} ${2.2 * r * Math.sin(heading)}`;

/** The walls of the office, or links and places of the map as it is now. @param {"office" | "map"} plate @returns {Promise<Drawing>} */
export async function drawingOf(plate) {
  if (plate === "office") {
    const { world } = await (await fetch("/api/world")).json();
    return { lines: world.walls.map((/** @type {Wall} */ wall) => [wall.from, wall.to]), dots: [], turn: 0 };
  }
  /** @type {{ map: { xy: Point[], links: [number, number][], turn_rad: number } }} */
  const { map } = await (await fetch("/api/state?map=1")).json();
  return { lines: map.links.map(([a, b]) => [map.xy[a], map.xy[b]]), dots: map.xy, turn: map.turn_rad };
}

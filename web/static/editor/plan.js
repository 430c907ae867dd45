// The office from above: the things of a world, what moves in it, the robot, and what is being drawn, on a sheet in metres that can
// be moved and zoomed.

import { svg } from "../ui/elements.js";
import { Walls } from "./walls.js";
import { away, corners, hinge, point, tip } from "./geometry.js";
import { endNear, kindOf, thingNear } from "./things.js";

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

const JOIN_PX = 9; // a click within this distance of a wall's end joins it
const NEAR_PX = 12; // a click within this distance selects a thing
const LAYERS = [
  "zones",
  "grid",
  "lamps",
  "people",
  "walls",
  "boxes",
  "doors",
  "marks",
  "walkers",
  "robot",
  "chosen",
  "draft",
  "cursor",
];

// What changes while the office runs, by layer: the list of the world that it is in, and the method below that draws it.
/** @type {Record<keyof Live, { list: ThingList, draws: "lamp" | "box" | "door" | "person" }>} */
const KINDS = {
  lamps: { list: "lamps", draws: "lamp" },
  boxes: { list: "boxes", draws: "box" },
  doors: { list: "doors", draws: "door" },
  walkers: { list: "people", draws: "person" },
};

/** @typedef {{ doors?: Record<string, number>, lamps?: Record<string, boolean> } & Partial<Moving>} Live */
/** @typedef {{ list: ThingList, item: any }} Chosen */

const kinds = /** @type {(keyof Live)[]} */ (Object.keys(KINDS));

export class Plan extends SvgView {
  /** @param {SVGSVGElement} place */
  constructor(place) {
    super(place, LAYERS);
    this.walls = new Walls(place, this.layers.walls, this.layers.grid);
    /** @type {World | null} */
    this.world = null;
    /** @type {Pose | null} */
    this.robot = null;
    /** @type {Chosen | null} */
    this.chosen = null;
    /** @type {Point[]} */
    this.drafted = [];
    /** @type {ToolName} */
    this.tool = "select";
    /** @type {Point | null} */
    this.crosshair = null;
    /** @type {Live} */
    this.live = {}; // doors (0 shut to 1), lamps (lit), boxes (there), walkers: by name, as the engine said last
  }

  /** @override @returns {Point[] | undefined} */
  get ring() {
    return this.world?.walls.filter((wall) => wall.outer).map((wall) => wall.from);
  }

  /** @param {World} world */
  show(world) {
    const other = this.world?.name !== world.name;
    this.world = world;
    if (other || !this.scale) this.fit();
    else this.draw();
  }

  /** The thing at a point; small ones go before large ones. @param {Point} p @returns {Place | null} */
  thingAt(p) {
    return this.world && thingNear(this.world, p, NEAR_PX / this.scale, this.live.walkers);
  }

  /** The grip of a thing at a point: its number, or null. @param {any} item @param {ThingList} list @param {Point} p */
  gripAt(item, list, p) {
    const near = NEAR_PX / this.scale;
    const found = kindOf(list)
      .grips(item)
      .findIndex((grip) => away(grip, p) <= near);
    return found < 0 ? null : found;
  }

  /** The end of a wall near a point, so that the new one joins it exactly; else null. @param {Point} p */
  endNear(p) {
    return this.world && endNear(this.world, p, JOIN_PX / this.scale);
  }

  // ---------------------------------------------------------------- drawing

  /** @override */
  draw() {
    if (!this.world || !this.scale) return;
    const world = this.world;
    this.fill(
      "zones",
      (world.slow_zones ?? []).map((zone) =>
        this.path("zone", zone.corners, true, `${zone.name}, ${Math.round(zone.factor * 100)} %`),
      ),
    );
    this.drawGrid();
    this.fill(
      "people",
      (world.people ?? []).flatMap((person) => this.way(person)),
    );
    this.walls.draw(world.walls, (p) => this.pixel(p));
    for (const kind of kinds) this.drawKind(kind);
    this.fill("marks", [
      ...world.starts.flatMap((start, k) => this.start(start, k)),
      ...(world.places ?? []).flatMap((p) => this.named(p)),
    ]);
    this.drawRobot(this.robot);
    this.choose(this.chosen);
    this.draft(this.drafted, this.tool);
    this.cursor(this.crosshair);
  }

  /** @param {LampItem} lamp */
  lamp(lamp) {
    const p = point(lamp.x, lamp.y);
    if (!(this.live.lamps?.[lamp.name] ?? lamp.on ?? true)) return [this.circle("bulb off", p, 6, `${lamp.name}, off`)];
    return [this.circle("glow", p, (lamp.reach ?? 4) * this.scale), this.circle("bulb", p, 6, lamp.name)];
  }

  /** @param {PersonItem} person */
  way(person) {
    const walk = person.path.length > 1 ? [this.path("way", person.path, person.loop ?? true)] : [];
    const stops = person.path.slice(1).map((p) => this.circle("stop", p, 3));
    return [...walk, ...stops, this.circle("home", person.path[0], 6, `${person.name} begins here`)];
  }

  /** A person where they are now; nothing while they are away. @param {PersonItem} person */
  person(person) {
    const now = this.live.walkers?.[person.name];
    if (!now) return [];
    const [x, y, heading] = now;
    const r = person.radius ?? 0.22;
    const nose = point(x + r * Math.cos(heading), y + r * Math.sin(heading));
    return [this.circle("head", [x, y], Math.max(5, r * this.scale), person.name), this.path("face", [[x, y], nose])];
  }

  /** @param {BoxItem} box */
  box(box) {
    const there = this.live.boxes ? this.live.boxes.includes(box.name) : (box.present ?? true);
    return [this.path(there ? "box" : "box away", corners(box), true, there ? box.name : `${box.name}, not there now`)];
  }

  /** @param {DoorItem} door */
  door(door) {
    const opening = this.live.doors?.[door.name] ?? ((door.open ?? true) ? 1 : 0);
    const r = (door.width * this.scale).toFixed(1);
    const [shut, open] = [tip(door), tip(door, 1)].map((p) =>
      this.pixel(p)
        .map((u) => u.toFixed(1))
        .join(" "),
    );
    const sweep = (door.swing_deg ?? 90) > 0 ? 0 : 1;
    const arc = door.slides ? [] : [svg("path", { d: `M${shut}A${r} ${r} 0 0 ${sweep} ${open}`, class: "swing" })];
    const leaf = [hinge(door, opening), tip(door, opening)];
    return [
      ...arc,
      this.path("sill", [door.hinge, tip(door)]),
      this.path("leaf", leaf, false, door.name),
      this.circle("hinge", leaf[0], 3),
    ];
  }

  /** @param {StartItem} start @param {number} number */
  start(start, number) {
    const [u, v] = this.pixel([start.x, start.y]);
    const turn = `translate(${u.toFixed(1)} ${v.toFixed(1)}) rotate(${-start.heading_deg})`;
    const made = svg("path", { d: "M13 0L-8 8L-4 0L-8 -8Z", transform: turn, class: number ? "start" : "start first" });
    made.append(svg("title", {}, start.name));
    return [made];
  }

  /** @param {PlaceItem} place */
  named(place) {
    const p = point(place.x, place.y);
    return [this.circle("place", p, 5), this.text("name", p, place.name)];
  }

  /** @param {Pose | null} robot */
  drawRobot(robot) {
    this.robot = robot;
    if (!robot || !this.scale) return;
    const p = point(robot.x, robot.y);
    const nose = point(robot.x + 0.24 * Math.cos(robot.heading_rad), robot.y + 0.24 * Math.sin(robot.heading_rad));
    const body = this.circle("body", p, Math.max(6, 0.2 * this.scale), "the robot");
    this.fill("robot", [body, this.path("nose", [p, nose])]);
  }

  /** What moves, as it is now. Only what has changed is drawn again. @param {Live} live */
  showLive(live) {
    const before = this.live;
    this.live = live;
    for (const kind of kinds) if (JSON.stringify(live[kind]) !== JSON.stringify(before[kind])) this.drawKind(kind);
  }

  /** @param {keyof Live} kind */
  drawKind(kind) {
    const { list, draws } = KINDS[kind];
    if (!this.world || !this.scale) return;
    const items = /** @type {any[]} */ (this.world[list] ?? []);
    this.fill(
      kind,
      items.flatMap((item) => this[draws](item)),
    );
  }

  /** Mark a thing and show its grips. @param {Chosen | null} chosen */
  choose(chosen) {
    this.chosen = chosen;
    if (!this.scale) return;
    if (!chosen) return this.fill("chosen", []);
    const { list, item } = chosen;
    this.fill("chosen", [
      ...this.outline(list, item, "mark"),
      ...kindOf(list)
        .grips(item)
        .map((grip) => this.circle("grip", grip, 6)),
    ]);
  }

  /** @param {ThingList} list @param {any} item @param {string} kind */
  outline(list, item, kind) {
    if (list === "walls") return [this.path(kind, [item.from, item.to])];
    if (list === "doors") return [this.path(kind, [item.hinge, tip(item)])];
    if (list === "boxes") return [this.path(kind, corners(item), true)];
    if (list === "slow_zones") return [this.path(kind, item.corners, true)];
    if (list === "people") return item.path.length > 1 ? [this.path(kind, item.path, item.loop ?? true)] : [];
    return [this.circle(kind, [item.x, item.y], 14)];
  }

  /** What is being drawn: the points so far, and the one under the pointer. @param {Point[]} points @param {ToolName} tool */
  draft(points, tool) {
    this.drafted = points;
    this.tool = tool;
    if (!this.scale) return;
    if (!points.length) return this.fill("draft", []);
    const [first, last] = [points[0], points[points.length - 1]];
    const parts = [];
    if (tool === "box" && points.length > 1)
      parts.push(this.path("ghost", [first, [last[0], first[1]], last, [first[0], last[1]]], true));
    else if (points.length > 1) parts.push(this.path("ghost", points, tool === "zone"));
    if (points.length > 1 && tool !== "start" && tool !== "place" && tool !== "lamp") {
      const before = points[points.length - 2];
      const middle = point((before[0] + last[0]) / 2, (before[1] + last[1]) / 2);
      const [w, d] = [Math.abs(last[0] - first[0]), Math.abs(last[1] - first[1])];
      const words = tool === "box" ? `${w.toFixed(2)} × ${d.toFixed(2)} m` : `${away(before, last).toFixed(2)} m`;
      if (away(before, last) * this.scale > 4) parts.push(this.text("size", middle, words));
    }
    this.fill("draft", [...parts, ...points.map((p) => this.circle("dot", p, 4))]);
  }

  /** @param {Point | null} p */
  cursor(p) {
    this.crosshair = p;
    if (!this.scale) return;
    if (!p) return this.fill("cursor", []);
    const [u, v] = this.pixel(p);
    this.fill("cursor", [svg("path", { d: `M${u - 11} ${v}h22M${u} ${v - 11}v22`, class: "cross" })]);
  }
}

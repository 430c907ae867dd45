// The office from above: the things of a world, what moves in it, the robot, and what is being drawn.

import { svg } from "../ui/elements.js";
import { SvgView } from "./svg_view.js";
import { Walls } from "./walls.js";
import { away, corners, hinge, point, tip } from "./geometry.js";
import { endNear, kindOf, thingNear } from "./things.js";

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

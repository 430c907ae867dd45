// The office from above, drawn as SVG: metres to pixels, the things of a world, the robot, what is being drawn.

import { svg } from "./icons.js";
import { THINGS, away, corners, hinge, tip } from "./things.js";

const LEAST_GRID_PX = 7;
const NEAR_PX = 12; // a click within this distance means a thing
const [LEAST, MOST] = [2, 2000]; // pixels a metre
const LAYERS = ["zones", "grid", "lamps", "people", "walls", "boxes", "doors", "marks", "robot", "chosen", "draft", "cursor"];

export class Plan {
  constructor(place) {
    this.place = place;
    this.layers = Object.fromEntries(LAYERS.map((name) => [name, svg("g", { class: name })]));
    place.append(...Object.values(this.layers));
    this.scale = 0; // pixels a metre; 0: not shown yet
    this.origin = [0, 0]; // where (0, 0) is on the plan, pixels
    new ResizeObserver(() => this.resized()).observe(place);
  }

  show(world) {
    const other = this.world?.name !== world.name;
    this.world = world;
    if (other || !this.scale) this.fit();
    else this.draw();
  }

  resized() {
    if (!this.world || !this.place.clientWidth) return;
    if (this.moved) this.draw();
    else this.fit();
  }

  // The whole outline on the plan.
  fit() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !this.world) return;
    this.moved = false; // by hand: until then a plan of another size shows all of it, too
    const ring = this.world.walls.filter((wall) => wall.outer).map((wall) => wall.from);
    const [xs, ys] = [ring.map((p) => p[0]), ring.map((p) => p[1])];
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

  // The thing at a point, the small ones first: {list, number}, or null.
  thingAt(p) {
    const near = NEAR_PX / this.scale;
    for (const list of ["places", "starts", "doors", "boxes", "lamps", "people", "walls", "slow_zones"]) {
      let best = null;
      (this.world[list] ?? []).forEach((item, number) => {
        const far = THINGS[list].far(item, p);
        if (far <= near && (best === null || far < best.far)) best = { list, number, far };
      });
      if (best) return { list, number: best.number };
    }
    return null;
  }

  // The grip of a thing at a point: its number, or null.
  gripAt(item, list, p) {
    const near = NEAR_PX / this.scale;
    const found = THINGS[list].grips(item).findIndex((grip) => away(grip, p) <= near);
    return found < 0 ? null : found;
  }

  // An end of a wall near a point, to join it exactly; else null.
  endNear(p) {
    let best = null;
    for (const wall of this.world.walls)
      for (const end of [wall.from, wall.to]) {
        const far = away(end, p);
        if (far * this.scale <= 9 && (best === null || far < best.far)) best = { end, far };
      }
    return best?.end ?? null;
  }

  // ---------------------------------------------------------------- drawing

  draw() {
    if (!this.world || !this.scale) return;
    const world = this.world;
    this.fill("zones", (world.slow_zones ?? []).map((zone) => this.path("zone", zone.corners, true, `${zone.name}, ${Math.round(zone.factor * 100)} %`)));
    this.drawGrid();
    this.fill("lamps", (world.lamps ?? []).flatMap((lamp) => this.lamp(lamp)));
    this.fill("people", (world.people ?? []).flatMap((person) => this.person(person)));
    this.drawWalls();
    this.fill("boxes", (world.boxes ?? []).map((box) => this.path("box", corners(box), true, box.name)));
    this.fill("doors", (world.doors ?? []).flatMap((door) => this.door(door)));
    this.fill("marks", [...world.starts.flatMap((start, k) => this.start(start, k)), ...(world.places ?? []).flatMap((p) => this.named(p))]);
    this.drawRobot(this.robot);
    this.choose(this.chosen);
    this.draft(this.drafted ?? [], this.tool);
    this.cursor(this.crosshair);
  }

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

  // One path for each kind, so that ten thousand walls are a few elements.
  drawWalls() {
    const paths = new Map();
    for (const wall of this.world.walls) {
      const kind = wall.outer ? "outer" : wall.bottom ? "high" : wall.kind === "glass" ? "glass" : wall.kind === "wall" ? "wall" : "low";
      const [[a, b], [c, d]] = [this.pixel(wall.from), this.pixel(wall.to)];
      paths.set(kind, `${paths.get(kind) ?? ""}M${a.toFixed(1)} ${b.toFixed(1)}L${c.toFixed(1)} ${d.toFixed(1)}`);
    }
    this.fill("walls", [...paths].map(([kind, d]) => svg("path", { d, class: kind })));
  }

  lamp(lamp) {
    const p = [lamp.x, lamp.y];
    return [this.circle("glow", p, lamp.reach * this.scale), this.circle("bulb", p, 6, lamp.name)];
  }

  person(person) {
    const walk = person.path.length > 1 ? [this.path("way", person.path, person.loop ?? true)] : [];
    const stops = person.path.slice(1).map((p) => this.circle("stop", p, 3));
    return [...walk, ...stops, this.circle("head", person.path[0], Math.max(5, (person.radius ?? 0.22) * this.scale), person.name)];
  }

  door(door) {
    const opening = this.openings?.[door.name] ?? (door.open ?? true ? 1 : 0);
    const r = (door.width * this.scale).toFixed(1);
    const [shut, open] = [tip(door), tip(door, 1)].map((p) => this.pixel(p).map((u) => u.toFixed(1)).join(" "));
    const sweep = (door.swing_deg ?? 90) > 0 ? 0 : 1;
    const arc = door.slides ? [] : [svg("path", { d: `M${shut}A${r} ${r} 0 0 ${sweep} ${open}`, class: "swing" })];
    const leaf = [hinge(door, opening), tip(door, opening)];
    return [...arc, this.path("sill", [door.hinge, tip(door)]), this.path("leaf", leaf, false, door.name), this.circle("hinge", leaf[0], 3)];
  }

  start(start, number) {
    const [u, v] = this.pixel([start.x, start.y]);
    const turn = `translate(${u.toFixed(1)} ${v.toFixed(1)}) rotate(${-start.heading_deg})`;
    const made = svg("path", { d: "M13 0L-8 8L-4 0L-8 -8Z", transform: turn, class: number ? "start" : "start first" });
    made.append(svg("title", {}, start.name));
    return [made];
  }

  named(place) {
    const p = [place.x, place.y];
    return [this.circle("place", p, 5), this.text("name", p, place.name)];
  }

  drawRobot(robot) {
    this.robot = robot;
    if (!robot || !this.scale) return;
    const p = [robot.x, robot.y];
    const nose = [robot.x + 0.24 * Math.cos(robot.heading_rad), robot.y + 0.24 * Math.sin(robot.heading_rad)];
    const body = this.circle("body", p, Math.max(6, 0.2 * this.scale), "the robot");
    this.fill("robot", [body, this.path("nose", [p, nose])]);
  }

  showDoors(openings) {
    const text = JSON.stringify(openings ?? {});
    if (text === this.doorsShown) return;
    this.doorsShown = text;
    this.openings = openings;
    if (this.world && this.scale) this.fill("doors", (this.world.doors ?? []).flatMap((door) => this.door(door)));
  }

  // Mark a thing and show its grips. chosen: {list, item} or null.
  choose(chosen) {
    this.chosen = chosen;
    if (!this.scale) return;
    if (!chosen) return this.fill("chosen", []);
    const { list, item } = chosen;
    this.fill("chosen", [...this.outline(list, item, "mark"), ...THINGS[list].grips(item).map((grip) => this.circle("grip", grip, 6))]);
  }

  outline(list, item, kind) {
    if (list === "walls") return [this.path(kind, [item.from, item.to])];
    if (list === "doors") return [this.path(kind, [item.hinge, tip(item)])];
    if (list === "boxes") return [this.path(kind, corners(item), true)];
    if (list === "slow_zones") return [this.path(kind, item.corners, true)];
    if (list === "people") return item.path.length > 1 ? [this.path(kind, item.path, item.loop ?? true)] : [];
    return [this.circle(kind, [item.x, item.y], 14)];
  }

  // What is being drawn: the points so far, and the one under the pointer.
  draft(points, tool) {
    this.drafted = points;
    this.tool = tool;
    if (!this.scale) return;
    if (!points.length) return this.fill("draft", []);
    const [first, last] = [points[0], points[points.length - 1]];
    const parts = [];
    if (tool === "box" && points.length > 1) parts.push(this.path("ghost", [first, [last[0], first[1]], last, [first[0], last[1]]], true));
    else if (points.length > 1) parts.push(this.path("ghost", points, tool === "zone"));
    if (points.length > 1 && tool !== "start" && tool !== "place" && tool !== "lamp") {
      const before = points[points.length - 2];
      const middle = [(before[0] + last[0]) / 2, (before[1] + last[1]) / 2];
      const [w, d] = [Math.abs(last[0] - first[0]), Math.abs(last[1] - first[1])];
      const words = tool === "box" ? `${w.toFixed(2)} × ${d.toFixed(2)} m` : `${away(before, last).toFixed(2)} m`;
      if (away(before, last) * this.scale > 4) parts.push(this.text("size", middle, words));
    }
    this.fill("draft", [...parts, ...points.map((p) => this.circle("dot", p, 4))]);
  }

  cursor(p) {
    this.crosshair = p;
    if (!this.scale) return;
    if (!p) return this.fill("cursor", []);
    const [u, v] = this.pixel(p);
    this.fill("cursor", [svg("path", { d: `M${u - 11} ${v}h22M${u} ${v - 11}v22`, class: "cross" })]);
  }
}

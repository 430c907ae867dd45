// The kinds of things in a world file: where they can be gripped, how they are moved, what can be typed in. No DOM.

const ROUND = 1000; // to the millimetre

export const at = (x, y) => [Math.round(x * ROUND) / ROUND, Math.round(y * ROUND) / ROUND];
const plus = ([x, y], [dx, dy]) => at(x + dx, y + dy);
export const away = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const turned = ([x, y], degrees) => {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return [x * c - y * s, x * s + y * c];
};
const degrees = (from, to) => round((Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI, 10);
export const round = (value, per = ROUND) => Math.round(value * per) / per;

export function toSegment(p, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const u = Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return away(p, [a[0] + u * dx, a[1] + u * dy]);
}

const toPath = (p, path) =>
  path.length === 1 ? away(p, path[0]) : Math.min(...path.slice(1).map((b, k) => toSegment(p, path[k], b)));

function within(p, ring) {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [[x, y], [u, v]] = [ring[i], ring[j]];
    if (y > p[1] !== v > p[1] && p[0] < ((u - x) * (p[1] - y)) / (v - y) + x) inside = !inside;
  }
  return inside;
}

export const length = (wall) => away(wall.from, wall.to);
export const tip = (door, opening = 0) => {
  if (door.slides) return plus(hinge(door, opening), turned([door.width, 0], door.angle_deg));
  return plus(door.hinge, turned([door.width, 0], door.angle_deg + opening * (door.swing_deg ?? 90)));
};
export const hinge = (door, opening = 0) =>
  door.slides ? plus(door.hinge, turned([-door.width * opening, 0], door.angle_deg)) : door.hinge;
export const corners = (box) => {
  const [a, b] = [box.width / 2, box.depth / 2];
  return [[-a, -b], [a, -b], [a, b], [-a, b]].map((corner) => plus([box.x, box.y], turned(corner, box.angle_deg ?? 0)));
};

const point = {
  grips: (item) => [[item.x, item.y]],
  far: (item, p) => away(p, [item.x, item.y]),
  shift: (item, d) => ({ ...item, ...xy(plus([item.x, item.y], d)) }),
  pull: (item, _k, p) => ({ ...item, ...xy(p) }),
};
const xy = ([x, y]) => ({ x, y });
const chain = (key, closed) => ({
  grips: (item) => item[key],
  far: (item, p) => (closed && within(p, item[key]) ? 0 : toPath(p, closed ? [...item[key], item[key][0]] : item[key])),
  shift: (item, d) => ({ ...item, [key]: item[key].map((q) => plus(q, d)) }),
  pull: (item, k, p) => ({ ...item, [key]: item[key].map((q, j) => (j === k ? p : q)) }),
});
const number = (key, title, low, high, step = 0.05) => ({ key, title, low, high, step, type: "number" });
const place = [number("x", "x, m", -1e4, 1e4), number("y", "y, m", -1e4, 1e4)];
const name = { key: "name", title: "Name", type: "text" };
const flag = (key, title) => ({ key, title, type: "checkbox" });

// What stays on a wall whose length has changed.
export function fitted(wall) {
  if (!wall.panels) return wall;
  const panels = wall.panels.filter((panel) => panel.at + panel.width <= length(wall) + 1e-9);
  return { ...wall, panels };
}

export const THINGS = {
  walls: {
    one: "wall",
    grips: (wall) => [wall.from, wall.to],
    far: (wall, p) => toSegment(p, wall.from, wall.to),
    shift: (wall, d) => ({ ...wall, from: plus(wall.from, d), to: plus(wall.to, d) }),
    pull: (wall, k, p) => fitted({ ...wall, [k ? "to" : "from"]: p }),
    fields: [
      number("from.0", "from x, m", -1e4, 1e4), number("from.1", "from y, m", -1e4, 1e4),
      number("to.0", "to x, m", -1e4, 1e4), number("to.1", "to y, m", -1e4, 1e4),
      { key: "kind", title: "Kind", type: "select", of: ["wall", "partition", "desk", "door", "window", "screen", "glass"] },
      number("height", "Height, m", 0.05, 20), { key: "colour", title: "Paint", type: "color" },
    ],
  },
  doors: {
    one: "door",
    grips: (door) => [door.hinge, tip(door)],
    far: (door, p) => toSegment(p, door.hinge, tip(door)),
    shift: (door, d) => ({ ...door, hinge: plus(door.hinge, d) }),
    pull: (door, k, p) => {
      const [from, to] = k ? [door.hinge, p] : [p, tip(door)];
      return { ...door, hinge: from, angle_deg: degrees(from, to), width: round(away(from, to)) };
    },
    fields: [
      name, number("hinge.0", "Hinge x, m", -1e4, 1e4), number("hinge.1", "Hinge y, m", -1e4, 1e4),
      number("width", "Width, m", 0.3, 6), number("angle_deg", "Shut, °", -360, 360, 5),
      number("swing_deg", "Swings by, °", -175, 175, 5), flag("slides", "Slides"), flag("open", "Open at the start"),
      number("period_s", "Every, s", 0, 1e6, 1), number("open_s", "open for, s", 0, 1e6, 1),
    ],
  },
  lamps: {
    one: "lamp", ...point,
    fields: [name, ...place, number("reach", "Reach, m", 0.5, 50, 0.5), number("brightness", "Brightness", 0, 3), flag("on", "On at the start")],
  },
  boxes: {
    one: "box",
    grips: (box) => corners(box),
    far: (box, p) => (within(p, corners(box)) ? 0 : toPath(p, [...corners(box), corners(box)[0]])),
    shift: (box, d) => ({ ...box, ...xy(plus([box.x, box.y], d)) }),
    pull: (box, k, p) => {
      const rest = corners(box)[(k + 2) % 4];
      const [width, depth] = turned([p[0] - rest[0], p[1] - rest[1]], -(box.angle_deg ?? 0)).map((side) => round(Math.max(0.05, Math.abs(side))));
      return { ...box, ...xy(at((p[0] + rest[0]) / 2, (p[1] + rest[1]) / 2)), width, depth };
    },
    fields: [
      name, ...place, number("width", "Width, m", 0.05, 20), number("depth", "Depth, m", 0.05, 20),
      number("height", "Height, m", 0.05, 20), number("angle_deg", "Turned by, °", -360, 360, 5),
      { key: "colour", title: "Paint", type: "color" }, flag("present", "There at the start"),
    ],
  },
  people: {
    one: "person", ...chain("path", false),
    fields: [name, number("speed", "Speed, m/s", 0.05, 2), number("wait_s.*", "Waits, s", 0, 1e6, 0.5), flag("loop", "In a circle")],
  },
  slow_zones: {
    one: "slow zone", ...chain("corners", true),
    fields: [name, number("factor", "Share of the speed", 0.05, 1)],
  },
  starts: { one: "start", ...point, fields: [name, ...place, number("heading_deg", "Looks to, °", -360, 360, 5)] },
  places: { one: "place", ...point, fields: [name, ...place] },
};

export function read(item, key) {
  const [head, rest] = key.split(".");
  return rest === undefined ? item[head] : item[head][rest === "*" ? 0 : Number(rest)];
}

export function written(item, key, value) {
  const [head, rest] = key.split(".");
  if (rest === undefined) return { ...item, [head]: value };
  return { ...item, [head]: item[head].map((old, k) => (rest === "*" || k === Number(rest) ? value : old)) };
}

export function newName(world, kind) {
  const taken = new Set((world[kind] ?? []).map((item) => item.name));
  let k = 1;
  while (taken.has(`${THINGS[kind].one} ${k}`)) k += 1;
  return `${THINGS[kind].one} ${k}`;
}

// The steps that move wall ends which lie on one of `moves` ([from, to] points), so that corners stay closed.
export function pulledEnds(world, moves, except = []) {
  const steps = [];
  world.walls.forEach((wall, number) => {
    if (except.includes(number)) return;
    let item = wall;
    for (const [from, to] of moves) {
      if (away(wall.from, from) < 1e-6) item = { ...item, from: to };
      if (away(wall.to, from) < 1e-6) item = { ...item, to };
    }
    if (item !== wall) steps.push({ do: "change", list: "walls", number, item: fitted(item) });
  });
  return steps;
}

// A door on an inner wall needs a gap in it: the wall becomes the parts on both sides of the leaf.
export function gapSteps(world, from, to) {
  const number = world.walls.findIndex((wall) =>
    !wall.outer && !wall.bottom && toSegment(from, wall.from, wall.to) < 0.03 && toSegment(to, wall.from, wall.to) < 0.03);
  if (number < 0) return [];
  const wall = world.walls[number];
  const [near, far] = [away(wall.from, from), away(wall.from, to)].sort((a, b) => a - b);
  const whole = length(wall);
  const along = (metres) => at(...[0, 1].map((k) => wall.from[k] + ((wall.to[k] - wall.from[k]) * metres) / whole));
  const part = (begin, end) => {
    const item = { ...wall, from: begin === 0 ? wall.from : along(begin), to: end === whole ? wall.to : along(end) };
    const panels = (wall.panels ?? []).filter((panel) => panel.at >= begin - 1e-9 && panel.at + panel.width <= end + 1e-9);
    if (wall.panels) item.panels = panels.map((panel) => ({ ...panel, at: round(Math.max(0, panel.at - begin)) }));
    return wall.panels ? fitted(item) : item;
  };
  const parts = [[0, near], [far, whole]].filter(([begin, end]) => end - begin > 0.02).map(([begin, end]) => part(begin, end));
  const steps = parts.map((item, k) => (k ? { do: "add", list: "walls", item } : { do: "change", list: "walls", number, item }));
  return steps.length ? steps : [{ do: "delete", list: "walls", number }];
}

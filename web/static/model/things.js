// The kinds of things in a world file: where they can be gripped, how they are moved, and their fields. No DOM.

import { LIMITS, WALL_KINDS } from "../shared.js";
import { at, away, corners, degrees, plus, round, tip, toArea, toPath, toSegment, turned } from "./geometry.js";
import { fitted, pulledEnds } from "./walls.js";

const LEAST_M = 0.05; // the least that can be seen and gripped; a file needs only more than 0

/** @param {Point} p */
const xy = ([x, y]) => ({ x, y });

/** @template {{ x: number, y: number }} T @returns {Omit<Kind<T>, "one" | "fields">} */
const point = () => ({
  grips: (item) => [[item.x, item.y]],
  far: (item, p) => away(p, [item.x, item.y]),
  shift: (item, d) => ({ ...item, ...xy(plus([item.x, item.y], d)) }),
  pull: (item, _grip, p) => ({ ...item, ...xy(p) }),
});

/**
 * A number of one list's items, within the world file's limits.
 * @param {ThingList} list
 * @param {string} key
 * @param {string} title
 * @returns {Field}
 */
const number = (list, key, title) => {
  const limits = /** @type {Record<string, Record<string, number[]>>} */ (LIMITS);
  const [low, high] = limits[list][key.split(".")[0]];
  return { key, title, low: key === "height" ? LEAST_M : low, high, type: "number" };
};
/** @param {ThingList} list */
const place = (list) => [number(list, "x", "x, m"), number(list, "y", "y, m")];
/** @type {Field} */
const name = { key: "name", title: "Name", type: "text" };
/** @type {Field} */
const paint = { key: "colour", title: "Paint", type: "color" };
/** @param {string} key @param {string} title @returns {Field} */
const flag = (key, title) => ({ key, title, type: "checkbox" });

/** @type {{ [L in ThingList]: Kind<Things[L]> }} */
export const THINGS = {
  walls: {
    one: "wall",
    grips: (wall) => [wall.from, wall.to],
    far: (wall, p) => toSegment(p, wall.from, wall.to),
    shift: (wall, d) => ({ ...wall, from: plus(wall.from, d), to: plus(wall.to, d) }),
    pull: (wall, grip, p) => fitted({ ...wall, [grip ? "to" : "from"]: p }),
    fields: [
      number("walls", "from.0", "from x, m"),
      number("walls", "from.1", "from y, m"),
      number("walls", "to.0", "to x, m"),
      number("walls", "to.1", "to y, m"),
      { key: "kind", title: "Kind", type: "select", of: WALL_KINDS },
      number("walls", "height", "Height, m"),
      paint,
    ],
  },
  doors: {
    one: "door",
    grips: (door) => [door.hinge, tip(door)],
    far: (door, p) => toSegment(p, door.hinge, tip(door)),
    shift: (door, d) => ({ ...door, hinge: plus(door.hinge, d) }),
    pull: (door, grip, p) => {
      const [from, to] = grip ? [door.hinge, p] : [p, tip(door)];
      return { ...door, hinge: from, angle_deg: degrees(from, to), width: round(away(from, to)) };
    },
    fields: [
      name,
      number("doors", "hinge.0", "Hinge x, m"),
      number("doors", "hinge.1", "Hinge y, m"),
      number("doors", "width", "Width, m"),
      number("doors", "angle_deg", "Shut, °"),
      number("doors", "swing_deg", "Swings by, °"),
      flag("slides", "Slides"),
      flag("open", "Open at the start"),
      number("doors", "period_s", "Every, s"),
      number("doors", "open_s", "open for, s"),
    ],
  },
  lamps: {
    one: "lamp",
    ...point(),
    fields: [
      name,
      ...place("lamps"),
      number("lamps", "reach", "Reach, m"),
      number("lamps", "brightness", "Brightness"),
      flag("on", "On at the start"),
    ],
  },
  boxes: {
    one: "box",
    grips: (box) => corners(box),
    far: (box, p) => toArea(p, corners(box)),
    shift: (box, d) => ({ ...box, ...xy(plus([box.x, box.y], d)) }),
    pull: (box, grip, p) => {
      const rest = corners(box)[(grip + 2) % 4];
      const [width, depth] = turned([p[0] - rest[0], p[1] - rest[1]], -(box.angle_deg ?? 0)).map((side) =>
        round(Math.max(LEAST_M, Math.abs(side))),
      );
      return { ...box, ...xy(at((p[0] + rest[0]) / 2, (p[1] + rest[1]) / 2)), width, depth };
    },
    fields: [
      name,
      ...place("boxes"),
      number("boxes", "width", "Width, m"),
      number("boxes", "depth", "Depth, m"),
      number("boxes", "height", "Height, m"),
      number("boxes", "angle_deg", "Turned by, °"),
      paint,
      flag("present", "There at the start"),
    ],
  },
  people: {
    one: "person",
    grips: (person) => person.path,
    far: (person, p) => toPath(p, person.path),
    shift: (person, d) => ({ ...person, path: person.path.map((q) => plus(q, d)) }),
    pull: (person, grip, p) => ({ ...person, path: person.path.with(grip, p) }),
    fields: [
      name,
      number("people", "speed", "Speed, m/s"),
      number("people", "wait_s.*", "Waits, s"),
      flag("loop", "In a circle"),
    ],
  },
  slow_zones: {
    one: "slow zone",
    grips: (zone) => zone.corners,
    far: (zone, p) => toArea(p, zone.corners),
    shift: (zone, d) => ({ ...zone, corners: zone.corners.map((q) => plus(q, d)) }),
    pull: (zone, grip, p) => ({ ...zone, corners: zone.corners.with(grip, p) }),
    fields: [name, number("slow_zones", "factor", "Share of the speed")],
  },
  starts: {
    one: "start",
    ...point(),
    fields: [name, ...place("starts"), number("starts", "heading_deg", "Looks to, °")],
  },
  places: { one: "place", ...point(), fields: [name, ...place("places")] },
};

/** The kind of a list's things, for callers that do not know statically which list it is. @param {ThingList} list */
export const kindOf = (list) => /** @type {Kind<any>} */ (THINGS[list]);

/** The value of an item at a key: `from.0` is one part of a list, `wait_s.*` stands for all parts. @param {any} item @param {string} key */
export function read(item, key) {
  const [head, rest] = key.split(".");
  if (rest === undefined) return item[head];
  return item[head]?.[rest === "*" ? 0 : Number(rest)];
}

/** The item with another value at a key. @template T @param {T} item @param {string} key @param {unknown} value @returns {T} */
export function written(item, key, value) {
  const [head, rest] = key.split(".");
  if (rest === undefined) return { ...item, [head]: value };
  const parts = /** @type {Record<string, unknown[] | undefined>} */ (item)[head] ?? [value];
  return { ...item, [head]: parts.map((old, k) => (rest === "*" || k === Number(rest) ? value : old)) };
}

/** A name that no thing of this list has. @param {Partial<World>} world @param {Exclude<ThingList, "walls">} list */
export function newName(world, list) {
  const taken = new Set((world[list] ?? []).map((item) => item.name));
  let k = 1;
  while (taken.has(`${THINGS[list].one} ${k}`)) k += 1;
  return `${THINGS[list].one} ${k}`;
}

/**
 * A thing dragged by a grip, or as a whole, from one point to another: the item as it is then, and the steps of the edit.
 * @param {Pick<World, "walls">} world
 * @param {Place & { grip: number | null, item: any }} held
 * @param {Point} from
 * @param {Point} to
 * @returns {{ now: any, steps: EditStep[] }}
 */
export function moved(world, { list, number, grip, item }, from, to) {
  const { shift, pull, grips } = kindOf(list);
  /** @type {Point} */
  const d = [to[0] - from[0], to[1] - from[1]];
  const now = grip === null ? shift(item, d) : pull(item, grip, plus(grips(item)[grip], d));
  /** @type {EditStep[]} */
  const steps = [{ do: "change", list, number, item: now }];
  if (list !== "walls" || (grip === null && !item.outer)) return { now, steps };
  /** @type {[Point, Point][]} */
  const ends = grips(item).map((end, k) => [end, grips(now)[k]]);
  const moves = grip === null ? ends : [ends[grip]];
  return { now, steps: [...steps, ...pulledEnds(world, moves, [number])] };
}

// The kinds of things in a world file: where they can be gripped, how they are moved, which is near a point, and the form beside the
// plan with the properties of the selected one.

import { LIMITS, WALL_KINDS } from "../shared.js";
import { at, away, corners, degrees, length, plus, round, tip, toArea, toPath, toSegment, turned } from "./geometry.js";
import { fitted, pulledEnds } from "./walls.js";
import { field as target, find } from "../ui/elements.js";

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

const RADIUS_M = 0.22; // of a person without a radius of their own
/** @type {ThingList[]} small things first, since they lie on large ones */
const ORDER = ["places", "starts", "doors", "boxes", "lamps", "people", "walls", "slow_zones"];

/**
 * The thing nearest to a point within `reach` metres, from the first list that has one. People who walk are also found where
 * they are now.
 * @param {Partial<World>} world
 * @param {Point} p
 * @param {number} reach
 * @param {Moving["walkers"]} [walkers]
 * @returns {Place | null}
 */
export function thingNear(world, p, reach, walkers = {}) {
  for (const list of ORDER) {
    const items = /** @type {any[]} */ (world[list] ?? []);
    const fars = items.map((item) => {
      const far = kindOf(list).far(item, p);
      if (list !== "people" || !item.name || !(item.name in walkers)) return far;
      const [x, y] = walkers[item.name];
      return Math.min(far, away([x, y], p) - (item.radius ?? RADIUS_M));
    });
    const least = fars.reduce((a, b) => Math.min(a, b), Infinity); // ten thousand walls would be too many arguments for Math.min
    if (least <= reach) return { list, number: fars.indexOf(least) };
  }
  return null;
}

/** The end of a wall nearest to a point within `reach` metres, or null. @param {Pick<World, "walls">} world @param {Point} p @param {number} reach */
export function endNear(world, p, reach) {
  /** @type {Point | null} */
  let best = null;
  for (const end of world.walls.flatMap((wall) => [wall.from, wall.to]))
    if (away(end, p) <= reach && (best === null || away(end, p) < away(best, p))) best = end;
  return best;
}

/** The form with the properties of the selected thing. */
export class Fields {
  /**
   * @param {HTMLFormElement} form
   * @param {(item: any) => void} change when something was typed in
   * @param {() => void} remove for the button
   */
  constructor(form, change, remove) {
    this.form = form;
    this.change = change;
    /** @type {(Place & { item: any }) | null} */
    this.thing = null;
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("input", (event) => {
      target(event).dataset.typed = "yes";
    });
    form.addEventListener("change", (event) => this.changed(target(event)));
    find(form, ".remove").addEventListener("click", remove);
  }

  /** @param {(Place & { item: any }) | null} thing */
  show(thing) {
    this.form.hidden = !thing;
    const same = thing && this.thing?.list === thing.list && this.thing?.number === thing.number;
    this.thing = thing;
    if (!thing) return;
    const { one, fields } = kindOf(thing.list);
    const metres = thing.list === "walls" ? `, ${length(thing.item).toFixed(2)} m` : "";
    find(this.form, "h2").textContent = `${one[0].toUpperCase()}${one.slice(1)}${metres}`;
    const rows = find(this.form, ".rows");
    if (!same) rows.replaceChildren(...fields.map((field) => row(field)));
    for (const field of fields) {
      /** @type {HTMLInputElement} */
      const input = find(rows, `[data-key="${CSS.escape(field.key)}"]`);
      if (input.dataset.typed) continue; // somebody is typing here, and news of the office must not overwrite it
      const value = read(thing.item, field.key);
      if (field.type === "checkbox") input.checked = value ?? field.key !== "slides";
      else input.value = value ?? DEFAULTS[field.key] ?? "";
    }
  }

  /** @param {HTMLInputElement} input */
  changed(input) {
    delete input.dataset.typed;
    if (!this.thing) return;
    const field = kindOf(this.thing.list).fields.find(({ key }) => key === input.dataset.key);
    if (!field || !input.reportValidity()) return;
    const typed = field.type === "number" ? Number(input.value) : input.value;
    this.change(written(this.thing.item, field.key, field.type === "checkbox" ? input.checked : typed));
  }
}

/** @type {Record<string, string | number>} */
const DEFAULTS = { kind: "wall", swing_deg: 90, period_s: 0, open_s: 0, angle_deg: 0 };

/** @param {Field} field */
function row({ key, title, type, low, high, of }) {
  const input = document.createElement(of ? "select" : "input");
  input.dataset.key = key;
  if (input instanceof HTMLSelectElement) input.append(...(of ?? []).map((name) => new Option(name)));
  else input.type = type;
  if (type === "number") Object.assign(input, { min: low, max: high, step: "any", required: true });
  if (type === "text") Object.assign(input, { maxLength: 40, required: true, autocomplete: "off" });
  const label = document.createElement("label");
  label.append(Object.assign(document.createElement("span"), { textContent: title }), input);
  if (type === "checkbox") label.classList.add("flag");
  return label;
}

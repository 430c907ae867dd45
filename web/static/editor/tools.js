// The drawing tools: how many points each takes, what to click next, and what the points make.

import { LIMITS } from "../shared.js";
import { at, away, degrees, round } from "./geometry.js";
import { newName } from "./things.js";
import { gapSteps } from "./walls.js";

/** @param {ThingList} list @param {object} item @returns {EditStep[]} */
const adds = (list, item) => [{ do: "add", list, item }];

/**
 * `takes`: how many points; Infinity: until Enter, with at least `least`. `says`: what to click next, by the number of points.
 * `makes(points, world, looks)`: the steps of one edit, or a sentence that says why there are none.
 * @type {Record<ToolName, Tool>}
 */
export const TOOLS = {
  select: {
    title: "Select",
    key: "v",
    says: ["Click a thing to select it, drag it to move it; drag the floor to move the plan."],
  },
  wall: {
    title: "Wall",
    key: "w",
    takes: 2,
    chain: true,
    list: "walls",
    says: ["Click where the wall begins.", "Click where it ends."],
    makes: ([from, to], _world, { kind, height }) => adds("walls", { from, to, kind, height }),
  },
  door: {
    title: "Door",
    key: "d",
    takes: 2,
    list: "doors",
    says: ["Click the hinge; on an inner wall the door makes its own gap.", "Click how far the shut leaf reaches."],
    makes([hinge, to], world) {
      const width = round(away(hinge, to));
      const [least, most] = LIMITS.doors.width;
      if (width < least || width > most) return `A door is ${least} to ${most} m wide; this one would be ${width} m.`;
      const item = { name: newName(world, "doors"), hinge, angle_deg: degrees(hinge, to), width };
      return [...gapSteps(world, hinge, to), ...adds("doors", item)];
    },
  },
  lamp: {
    title: "Lamp",
    key: "l",
    takes: 1,
    list: "lamps",
    says: ["Click where the lamp hangs."],
    makes: ([[x, y]], world) =>
      adds("lamps", { name: newName(world, "lamps"), x, y, reach: 4, brightness: 0.5, on: true }),
  },
  box: {
    title: "Box",
    key: "b",
    takes: 2,
    list: "boxes",
    says: ["Click a corner of the box.", "Click the corner opposite."],
    makes([a, b], world) {
      const [width, depth] = [round(Math.abs(a[0] - b[0])), round(Math.abs(a[1] - b[1]))];
      const [least] = LIMITS.boxes.width;
      if (Math.min(width, depth) < least)
        return `A box is at least ${least} m each way; this one would be ${width} × ${depth} m.`;
      const [x, y] = at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
      return adds("boxes", { name: newName(world, "boxes"), x, y, width, depth });
    },
  },
  person: {
    title: "Person",
    key: "p",
    takes: Infinity,
    least: 1,
    list: "people",
    says: [
      "Click the first point of the path.",
      "Click the next point, or finish: somebody who stands there.",
      "Click the next point, or finish.",
    ],
    makes: (path, world) => adds("people", { name: newName(world, "people"), path, loop: path.length > 2 }),
  },
  zone: {
    title: "Slow zone",
    key: "z",
    takes: Infinity,
    least: 3,
    list: "slow_zones",
    says: [
      "Click a corner of the slow floor.",
      "Click the next corner.",
      "Click the next corner.",
      "Click the next corner, or finish.",
    ],
    makes: (corners, world) => adds("slow_zones", { name: newName(world, "slow_zones"), corners, factor: 0.5 }),
  },
  start: {
    title: "Start",
    key: "s",
    takes: 2,
    list: "starts",
    says: ["Click where a robot may start; the first of all starts is used.", "Click where it looks to."],
    makes: ([from, to], world) =>
      adds("starts", { name: newName(world, "starts"), x: from[0], y: from[1], heading_deg: degrees(from, to) }),
  },
  place: {
    title: "Place",
    key: "n",
    takes: 1,
    list: "places",
    says: ["Click the place; give it a name afterwards."],
    makes: ([[x, y]], world) => adds("places", { name: newName(world, "places"), x, y }),
  },
  delete: { title: "Delete", key: "x", says: ["Click what is to go."] },
};

/** What to click next. @param {ToolName} tool @param {number} points how many there are */
export const hintOf = (tool, points) => TOOLS[tool].says[Math.min(points, TOOLS[tool].says.length - 1)];

/** The tool of a key. @param {string} key */
export const toolOf = (key) => names.find((name) => TOOLS[name].key === key.toLowerCase());

const names = /** @type {ToolName[]} */ (Object.keys(TOOLS));

// Walls that change because something else has changed: corners stay closed, a door gets its gap. No DOM.

import { at, away, length, round, toSegment } from "./geometry.js";

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

// Finds things of a world near a point. No DOM.

import { away } from "./geometry.js";
import { kindOf } from "./things.js";

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

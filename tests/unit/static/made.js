// What these tests are made of: random numbers, the same in every run; points, paths and walls.

/** @param {number} seed @returns {() => number} from 0 to 1 */
export function chance(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** @param {number} count @param {number} [seed] @returns {Point[]} within 10 m of the middle */
export function points(count, seed = 1) {
  const next = chance(seed);
  return Array.from({ length: count }, () => [next() * 20 - 10, next() * 20 - 10]);
}

/** Points as they are written in an SVG: "0 0, 4 0". @param {string} text @returns {Point[]} */
export const path = (text) => text.split(", ").map((pair) => /** @type {Point} */ (pair.split(" ").map(Number)));

/** @param {string} text */
export const segment = (text) => /** @type {[Point, Point]} */ (path(text));

/** A wall of a world. @param {string} ends @param {Partial<Wall>} [rest] @returns {Wall} */
export function wall(ends, rest = {}) {
  const [from, to] = segment(ends);
  return { from, to, height: 2.5, colour: "#ffffff", ...rest };
}

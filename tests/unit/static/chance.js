// Random numbers, the same in every run.

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

/** A wall of a world. @param {Point} from @param {Point} to @param {Partial<Wall>} [rest] @returns {Wall} */
export const wall = (from, to, rest = {}) => ({ from, to, height: 2.5, colour: "#ffffff", ...rest });

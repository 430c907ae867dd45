// Two fingers on a picture in perspective: what lies between them stays between them. No DOM.

/**
 * @typedef {readonly [number, number]} Point pixels, from the middle of the picture, to the right and downwards
 * @typedef {readonly [Point, Point]} Fingers
 */

/**
 * Where a camera belongs when two fingers have moved from `before` to `after`: how far from what it looks at, and by how much
 * that is to be moved to the right and downwards.
 * @param {Fingers} before
 * @param {Fingers} after
 * @param {{ distance: number, unit: number }} camera `unit`: how large a pixel is there, at a distance of 1
 */
export function pinched(before, after, { distance, unit }) {
  const nearer = Math.max(spread(after), 1) / Math.max(spread(before), 1);
  const far = distance / nearer;
  const [from, to] = [middle(before), middle(after)];
  return {
    distance: far,
    right: unit * (from[0] * distance - to[0] * far),
    down: unit * (from[1] * distance - to[1] * far),
  };
}

/** @param {Fingers} fingers */
const spread = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** @param {Fingers} fingers */
const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];

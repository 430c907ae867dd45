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

// The fingers of one gesture, from the first that touches to the last that is lifted. A busy browser leaves out moves, the last
// one too, and tells where a finger is when it is lifted; fingers that are lifted together are told of one after the other.
export class Gesture {
  constructor() {
    /** @type {Map<number, Point>} */
    this.places = new Map();
    /** @type {Set<number>} */
    this.lifted = new Set();
  }

  get fingers() {
    return this.places.size - this.lifted.size;
  }

  /** @param {number} finger */
  has(finger) {
    return this.places.has(finger) && !this.lifted.has(finger);
  }

  /** @param {number} finger @param {Point} at */
  down(finger, at) {
    for (const gone of this.lifted) this.places.delete(gone);
    this.lifted.clear();
    this.places.set(finger, at);
  }

  /**
   * Where two fingers were and are; null while there are not two.
   * @param {number} finger @param {Point} at
   * @returns {[Fingers, Fingers] | null}
   */
  move(finger, at) {
    const moved = this.put(finger, at);
    return this.lifted.size ? null : moved;
  }

  /**
   * The same where one is lifted, also just after the other.
   * @param {number} finger @param {Point | null} at null: where that is is not known
   */
  up(finger, at) {
    const moved = at && this.put(finger, at);
    this.lifted.add(finger);
    if (this.fingers === 0) {
      this.places.clear();
      this.lifted.clear();
    }
    return moved;
  }

  /** @param {number} finger @param {Point} at @returns {[Fingers, Fingers] | null} */
  put(finger, at) {
    const before = [...this.places.values()];
    this.places.set(finger, at);
    const after = [...this.places.values()];
    return before.length === 2 ? [/** @type {any} */ (before), /** @type {any} */ (after)] : null;
  }
}

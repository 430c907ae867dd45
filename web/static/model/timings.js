// What the parts of a tick cost, in words. No DOM.

/** @typedef {[part: string, mean_ms: number, worst_ms: number]} Timing */

/**
 * The time of all parts together, compared with the time available.
 * @param {Timing[]} parts
 * @param {number} thereAre_ms
 */
export function tickWords(parts, thereAre_ms) {
  const all = parts.reduce((sum, [, mean_ms]) => sum + mean_ms, 0);
  return `A tick takes ${all.toFixed(2)} of its ${thereAre_ms.toFixed(0)} ms`;
}

/** @param {Timing} timing */
export const partWords = ([, mean_ms, worst_ms]) => `${mean_ms.toFixed(2)}, worst ${worst_ms.toFixed(1)} ms`;

/** A part's time as a share of the most expensive part's. @param {Timing[]} parts @param {Timing} timing */
export const shareOf = (parts, [, mean_ms]) => mean_ms / Math.max(1e-9, ...parts.map(([, other_ms]) => other_ms));

// Words about moments, and names for files of them. No DOM.

/** @param {Moment} moment @param {string} time */
export function momentWords({ tick, state_hash, orders }, time) {
  const given = orders === 0 ? "no orders" : orders === 1 ? "one order" : `${orders.toLocaleString("en")} orders`;
  return `${time}, tick ${tick}, with ${given}. Whoever opens it plays the run up to here and gets the same bits: state hash ${state_hash.slice(0, 12)}.`;
}

/** @param {number} bytes */
export const sizeWords = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

/** The run and the moment, for the name of a file. @param {string | null} world @param {number} seed @param {number} time_s */
export function nameOfMoment(world, seed, time_s) {
  const minutes = Math.floor(time_s / 60 + 1e-9);
  const seconds = Math.max(0, time_s - 60 * minutes).toFixed(1);
  const where = (world ?? "recording").replace(/[^A-Za-z0-9]+/g, "-");
  return `${where}-seed${seed}-${minutes}m${seconds.padStart(4, "0")}s`;
}

/** The link in an address; null: there is none. @param {string} hash */
export const linkIn = (hash) => /^#(run=.+)$/.exec(hash)?.[1] ?? null;

/** What the note says while a situation is played, and when it is there. @param {SituationFields} situation */
export function situationWords({ state, tick, end_tick, words }) {
  const titles = {
    playing: "Playing up to the moment",
    same: "The same run",
    other: "Not the same run",
    stopped: "Not there",
  };
  const far = `tick ${tick.toLocaleString("en")} of ${end_tick.toLocaleString("en")}`;
  return { title: titles[state], words: state === "playing" ? far : words, share: end_tick ? tick / end_tick : 1 };
}

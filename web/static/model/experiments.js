// The words and the order of the experiments' gallery. No DOM.

import { clock } from "../ui/words.js";

/** @type {Record<EngineName, string>} */
const ENGINES = { ours: "our rules", paper: "the paper's rules" };
const BEFORE_S = 10; // a trial plays from so long before its moment

/** @param {EngineName} engine */
export const engineWords = (engine) => ENGINES[engine];

/** How long a trial is, about. @param {number} seconds */
export function lengthWords(seconds) {
  if (seconds < 90) return `${Math.max(5, 5 * Math.round(seconds / 5))} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

/** @param {Card} card */
export function facts({ axes, seconds, done }) {
  const settings = axes.reduce((product, { levels }) => product * levels.length, 1);
  const words = [`${lengthWords(seconds)} a trial`];
  if (settings > 1) words.push(`${settings} settings`);
  if (done) words.push(`${done.toLocaleString("en")} ${done === 1 ? "trial" : "trials"} run here`);
  return words.join(" · ");
}

/** The engine that is chosen at first. @param {Card} card */
export const firstEngine = ({ engines }) => (engines.includes("ours") ? "ours" : engines[0]);

/**
 * The cells of one engine as rows: the first axis goes across, the second one down. Of further axes only the levels in
 * `fixed` are shown.
 * @param {Card} card
 * @param {Results} results
 * @param {EngineName} engine
 * @param {string[]} fixed
 */
export function rowsOf({ axes }, { cells }, engine, fixed) {
  const [across, down] = axes;
  /** @param {string[]} levels */
  const at = (levels) =>
    cells.find((cell) => cell.engine === engine && levels.every((level, k) => cell.levels[k] === level));
  const labels = down ? down.levels : [""];
  return labels.map((label) => ({
    label,
    cells: (across ? across.levels : [""]).map((level) =>
      at([...(across ? [level] : []), ...(down ? [label] : []), ...fixed]),
    ),
  }));
}

/** How a trial went: its dot's look. @param {Dot} dot @returns {"all" | "some" | "none" | "plain"} */
export function lookOf({ good, of }) {
  if (good === null || of === null || of === 0) return "plain";
  if (good >= of) return "all";
  return good > 0 ? "some" : "none";
}

/** What stands on a dot. @param {Dot} dot */
export const dotFace = ({ good, of, words }) => (of ? `${good}/${of}` : words);

/** @param {Dot} dot @param {Results} results */
export function dotWords(dot, { score, is_rate }) {
  const how = is_rate ? `${dot.words} ${score}` : `${score} ${dot.words}`;
  const from = clock(Math.max(0, dot.moment_s - BEFORE_S));
  return `Seed ${dot.seed}: ${how}. Decided at ${clock(dot.moment_s)}: ${dot.moment}. Plays from ${from}.`;
}

/** @param {{ levels: string[] }} cell */
export const settingWords = ({ levels }) => levels.join(", ") || "as it is";

/**
 * What the note on the stage says of a trial that is being watched.
 * @param {Trial} trial
 * @param {number} time_s
 */
export function trialWords(trial, time_s) {
  const settings = [engineWords(trial.engine), ...trial.levels, `seed ${trial.seed}`].join(" · ");
  const which = `Experiment ${trial.experiment}`;
  if (trial.state !== "running") {
    const doing = trial.state === "over" ? `over: ${trial.outcome}` : `ended: ${trial.outcome}`;
    return { which, settings, doing, clock: "", share: trial.state === "over" ? 1 : null };
  }
  if (trial.ahead !== null) {
    const doing = "going to the moment that decided it";
    return { which, settings, doing, clock: `${Math.floor(100 * trial.ahead)} %`, share: trial.ahead };
  }
  const time = `${clock(time_s)} of about ${clock(trial.about_s)}`;
  const doing = trial.altered ? `${trial.doing}, changed by hand` : trial.doing;
  return { which, settings, doing, clock: time, share: Math.min(1, time_s / Math.max(1, trial.about_s)) };
}

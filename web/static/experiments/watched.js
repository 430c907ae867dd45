// The note on the stage about the trial that is being watched: what is being done, how far it is, and what came of it.

import { $, find, say } from "../ui/elements.js";
import { toast } from "../ui/toasts.js";
import { clock, sentence } from "../ui/words.js";
import { engineWords } from "./grid.js";

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

export class Watched {
  /** @param {{ here: () => void, again: (wish: WatchExperiment) => void, more: () => void }} actions */
  constructor({ here, again, more }) {
    this.box = $("trial");
    /** @type {Trial | null} */
    this.trial = null;
    this.run = -1;
    this.away = -1; // the run whose note was put away
    $("trial-here").addEventListener("click", here);
    $("trial-more").addEventListener("click", more);
    $("trial-again").addEventListener("click", () => this.trial && again(wishOf(this.trial)));
    $("trial-close").addEventListener("click", () => {
      this.away = this.run;
      this.box.hidden = true;
    });
  }

  /** @param {State} state @param {PageFields} page */
  show({ trial, time_s }, { run }) {
    const before = run === this.run ? this.trial : null;
    if (before?.state === "running" && trial?.state === "over")
      toast(`The trial is over: ${sentence(trial.outcome)}`, { notice: true });
    [this.trial, this.run] = [trial, run];
    this.box.hidden = !trial || this.away === run;
    if (!trial || this.box.hidden) return;
    const words = trialWords(trial, time_s);
    this.box.dataset.state = trial.state;
    say(find(this.box, ".which"), words.which);
    find(this.box, ".head").title = trial.title;
    say(find(this.box, ".settings"), words.settings);
    say(find(this.box, ".doing"), words.doing); // only when it changes, since it is then read aloud
    say(find(this.box, ".clock"), words.clock);
    const bar = /** @type {HTMLProgressElement} */ (find(this.box, "progress"));
    bar.hidden = words.share === null;
    bar.value = words.share ?? 0;
    $("trial-here").hidden = trial.ahead === null;
    $("trial-again").hidden = $("trial-more").hidden = trial.state === "running";
  }
}

/** @param {Trial} trial @returns {WatchExperiment} */
function wishOf({ experiment, id }) {
  return { type: "watch_experiment", experiment, trial: id };
}

// Tick: one tick stage by stage, and what the parts of a tick cost.

import { make, say } from "../ui/elements.js";
import { Bar, heading, note } from "./parts.js";

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

const NOTHING = "Next stage pauses, and shows one tick stage by stage.";
const TRUE = "The tick is computed whole; pose cells and map are shown as they were at each stage.";
/** @type {Record<string, Command>} */
const ORDERS = {
  back: { type: "step_stage", back: true },
  "next stage": { type: "step_stage" },
  tick: { type: "step" },
  play: { type: "resume" },
};

export class TickTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    const buttons = Object.entries(ORDERS).map(([words, order]) => {
      const button = make("button", { type: "button", textContent: words });
      button.addEventListener("click", () => ask(order));
      return button;
    });
    const go = make("div", { className: "buttons", title: "The keys: comma and full stop." }, ...buttons);
    go.setAttribute("role", "group");
    go.setAttribute("aria-label", "Go");
    this.title = heading("");
    this.list = make("ol", { className: "stages" });
    this.words = note("");
    this.cost = heading("");
    this.timings = make("div", { className: "timings" });
    const how = note("Mean and worst of the last hundred ticks.");
    this.box = make("div", {}, go, this.title, this.list, this.words, this.cost, how, this.timings);
    /** @type {{ name: HTMLElement, words: HTMLElement, bar: Bar }[]} */
    this.rows = [];
  }

  /** @param {{ at: number | null, stages: [string, string][] }} data */
  walk({ at, stages }) {
    say(this.title, at === null ? "One tick, stage by stage" : `Stage ${at + 1} of ${stages.length}`);
    say(this.words, at === null ? NOTHING : TRUE);
    const rows = stages.map(([title, words], k) => {
      const row = make("li", {}, make("b", { textContent: title }), make("span", { textContent: words }));
      row.className = words ? "" : "to-come";
      if (k === at) row.setAttribute("aria-current", "step");
      return row;
    });
    this.list.replaceChildren(...rows);
    this.list.hidden = at === null;
    if (at !== null) rows[at].scrollIntoView({ block: "nearest" });
  }

  /** @param {{ there_are_ms: number, parts: Timing[] }} data */
  cost_of({ there_are_ms, parts }) {
    say(this.cost, tickWords(parts, there_are_ms));
    while (this.rows.length < parts.length) this.add();
    while (this.rows.length > parts.length) this.rows.pop()?.name.parentElement?.parentElement?.remove();
    parts.forEach((timing, k) => {
      say(this.rows[k].name, timing[0]);
      say(this.rows[k].words, partWords(timing));
      this.rows[k].bar.show(shareOf(parts, timing), "known");
    });
  }

  add() {
    const row = { name: make("span"), words: make("span"), bar: new Bar() };
    this.rows.push(row);
    this.timings.append(make("div", {}, make("div", { className: "timing" }, row.name, row.words), row.bar.box));
  }

  get parts() {
    return { walk: this.walk.bind(this), timings: this.cost_of.bind(this) };
  }
}

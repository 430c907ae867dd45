// What was run of one experiment: a grid of cells, and the trials of the cell that is chosen as dots.

import { clock, ended } from "../ui/words.js";
import { $, icon, make } from "../ui/elements.js";

/** @type {Record<EngineName, string>} */
const RULES = {
  ours: "our rules",
  paper: "the paper's rules",
  "paper-2005": "the rules of 2005",
  "paper-2006": "the rules of 2006",
};
const MOST_SEEDS = 50;
const BEFORE_S = 10; // a trial plays from so long before its moment

/** @param {EngineName} engine */
export const engineWords = (engine) => RULES[engine];

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

/** Whether it missed something of what it was to reach. @param {Dot} dot */
export const fellShort = (dot) => ["some", "none"].includes(lookOf(dot));

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

const PLAYS = " A dot plays its trial from the moment that decided it.";

export class Grid {
  /** @param {(wish: WatchExperiment) => void} watch */
  constructor(watch) {
    this.watch = watch;
    /** @type {ExperimentDetail | null} */
    this.detail = null;
    /** @type {EngineName} */
    this.engine = "ours";
    /** @type {string[]} */
    this.fixed = [];
    /** @type {Cell | null} */
    this.cell = null;
    $("cell-watch").addEventListener("click", () => this.cell && watch(this.wish(this.cell)));
    $("cell-short").addEventListener("click", () => {
      const dot = this.cell?.dots.find(fellShort);
      if (this.cell && dot) watch(this.wishFor(this.cell, dot));
    });
  }

  /** @param {ExperimentDetail} detail @param {EngineName} [engine] @param {string[]} [levels] */
  show(detail, engine, levels = detail.card.watch) {
    const { card, results } = detail;
    this.detail = detail;
    this.engine = engine ?? firstEngine(card);
    this.fixed = levels.slice(2);
    $("one-asks").textContent = card.asks;
    $("one-found").textContent = `The paper: ${ended(card.found)}`;
    $("one-note").hidden = !results.note;
    $("one-note").textContent = results.note;
    this.showChoices(card);
    this.draw();
    this.choose(levels);
  }

  /** @param {Card} card */
  showChoices({ name, engines, axes }) {
    const radios = engines.map((engine) => {
      const radio = make("input", { type: "radio", name: `engine-${name}`, value: engine });
      radio.checked = engine === this.engine;
      radio.addEventListener("change", () => {
        this.engine = engine;
        this.draw();
        this.choose(this.cell?.levels ?? []);
      });
      return make("label", {}, radio, engineWords(engine));
    });
    $("one-engines").hidden = radios.length < 2;
    $("one-engines").replaceChildren(make("legend", { className: "gone", textContent: "Engine" }), ...radios);
    const selects = axes.slice(2).map((axis, k) => {
      const select = make("select", {});
      select.append(...axis.levels.map((level) => new Option(level, level)));
      select.value = this.fixed[k];
      select.addEventListener("change", () => {
        this.fixed[k] = select.value;
        this.draw();
        this.choose([...(this.cell?.levels.slice(0, 2) ?? []), ...this.fixed]);
      });
      return make("label", {}, `${axis.name} `, select);
    });
    $("one-fixed").replaceChildren(...selects);
  }

  draw() {
    if (!this.detail) return;
    const { card, results } = this.detail;
    const [across, down] = card.axes;
    $("one-grid").hidden = !across;
    if (!across) return;
    const corner = down ? `${down.name} ↓  ${across.name} →` : across.name;
    const head = make("tr", {}, make("td", { className: "corner", textContent: corner }));
    for (const label of across.levels) head.append(make("th", { scope: "col", textContent: label }));
    const body = rowsOf(card, results, this.engine, this.fixed).map(({ label, cells }) =>
      make(
        "tr",
        {},
        make("th", { scope: "row", textContent: label || results.score }),
        ...cells.map((cell) => make("td", {}, ...(cell ? [this.button(cell)] : []))),
      ),
    );
    const caption = make("caption", {
      textContent: `${results.score}, ${engineWords(this.engine)}, with 95 % intervals`,
    });
    $("one-grid").replaceChildren(make("table", {}, caption, make("thead", {}, head), make("tbody", {}, ...body)));
  }

  /** @param {Cell} cell */
  button(cell) {
    const button = make("button", { type: "button", className: "cell" });
    const [value, ...interval] = cell.words.split(" (");
    button.append(make("b", { textContent: cell.n ? value : "–" }));
    if (interval.length) button.append(make("small", { textContent: interval[0].replace(")", "") }));
    if (cell.shade !== null) button.style.setProperty("--shade", `${Math.round(100 * cell.shade)}%`);
    button.dataset.levels = JSON.stringify(cell.levels);
    button.ariaLabel = `${settingWords(cell)}: ${cell.n ? `${cell.words}, ${count(cell.n)}` : "no trial yet"}`;
    button.addEventListener("click", () => this.choose(cell.levels));
    return button;
  }

  /** Show the trials of a cell. @param {string[]} levels */
  choose(levels) {
    if (!this.detail) return;
    const { card, results } = this.detail;
    const same = (/** @type {Cell} */ { engine, levels: its }) =>
      engine === this.engine && its.every((level, k) => level === levels[k]);
    const cell = results.cells.find(same) ?? results.cells.find(({ engine }) => engine === this.engine) ?? null;
    this.cell = cell;
    if (!cell) return;
    for (const button of $("one-grid").querySelectorAll("button"))
      button.setAttribute("aria-pressed", String(button.dataset.levels === JSON.stringify(cell.levels)));
    $("cell-title").textContent = [...cell.levels, engineWords(this.engine)].join(", ");
    const short = cell.dots.filter(fellShort).length;
    const fell = results.is_rate && cell.dots.length ? ` ${short || "None"} of them fell short.` : "";
    $("cell-words").textContent = cell.n
      ? `${results.score}: ${cell.words}, ${count(cell.n)}.${fell}${cell.dots.length ? PLAYS : ""}`
      : "";
    $("cell-short").hidden = !short;
    $("cell-none").hidden = cell.dots.length > 0;
    $("cell-none").textContent =
      `None of these was run here yet, so a dot plays its trial from the start. To run them all: ratslam experiment ${card.name}`;
    const dots = cell.dots.map((dot) => this.dot(cell, dot, results));
    $("cell-dots").replaceChildren(...(dots.length ? dots : this.seeds(card).map((seed) => this.unrun(cell, seed))));
  }

  /** Of the trials that the experiment has. @param {Card} card */
  seeds({ seed, trials }) {
    return Array.from({ length: Math.min(trials, MOST_SEEDS) }, (_, k) => seed + k);
  }

  /** A trial of which nothing is known. @param {Cell} cell @param {number} seed */
  unrun(cell, seed) {
    const title = `Seed ${seed}: not run here yet. Plays from the start.`;
    const button = make("button", { type: "button", className: "dot", title, ariaLabel: title });
    button.dataset.look = "plain";
    button.append(make("b", {}, icon("play")), make("small", { textContent: String(seed) }));
    button.addEventListener("click", () => this.watch({ ...this.wish(cell), seed }));
    return make("li", {}, button);
  }

  /** @param {Cell} cell @param {Dot} dot @param {Results} results */
  dot(cell, dot, results) {
    const button = make("button", { type: "button", className: "dot", title: dotWords(dot, results) });
    button.ariaLabel = dotWords(dot, results);
    button.dataset.look = lookOf(dot);
    button.append(make("b", { textContent: dotFace(dot) }), make("small", { textContent: String(dot.seed) }));
    button.addEventListener("click", () => this.watch(this.wishFor(cell, dot)));
    return make("li", {}, button);
  }

  /** @param {Cell} cell @param {Dot} dot @returns {WatchExperiment} */
  wishFor(cell, { seed, quick, id, moment_s }) {
    return { ...this.wish(cell), seed, quick, ...(id ? { trial: id } : {}), moment_s };
  }

  /** @param {Cell} cell @returns {WatchExperiment} */
  wish({ engine, levels }) {
    return { type: "watch_experiment", experiment: this.detail?.card.name ?? "", engine, levels };
  }
}

/** @param {number} trials */
const count = (trials) => `${trials} ${trials === 1 ? "trial" : "trials"}`;

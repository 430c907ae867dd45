// The experiments of the papers in a dialog: all of them as cards, or one with its trials. And the note on the stage about the trial
// that is being watched.

import { $, find, icon, make, say, svg } from "../ui/elements.js";
import { engineWords, firstEngine, Grid } from "./grid.js";
import { clock, sentence, sourceWords, toast } from "../ui/words.js";
import { get, reasons } from "../net/post.js";

/** The plan of an experiment's world: stands for its figure until there is one. @param {PlanDrawing} plan */
function planOf({ width, depth, left, bottom, walls, way, places }) {
  const dots = places.map(([x, y]) => svg("circle", { cx: x, cy: y, r: Math.max(width, depth) / 45, class: "goal" }));
  const upright = svg(
    "g",
    { transform: `translate(${-left} ${bottom + depth}) scale(1 -1)` },
    svg("path", { d: walls, class: "walls" }),
    svg("path", { d: way, class: "way" }),
    ...dots,
  );
  return svg("svg", { viewBox: `0 0 ${width} ${depth}`, class: "plan", "aria-hidden": "true" }, upright);
}

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

/** A card by all that it says; "figures 6 to 15" is every figure between. @param {Card} card @param {string} wanted */
export function matches({ title, paper, asks, found, world }, wanted) {
  const tokens = (/** @type {string} */ words) => words.toLowerCase().match(/[\p{L}]+|[\d.]*\d/gu) ?? [];
  const said = `${title} ${sourceWords(paper)} ${asks} ${found} ${world}`;
  const between = [...paper.matchAll(/(\d+) to (\d+)/g)].flatMap(([, from, to]) =>
    Array.from({ length: Math.max(0, +to - +from) }, (_, k) => String(+from + k)),
  );
  const known = [...tokens(said), ...between];
  return tokens(wanted).every((token) =>
    known.some((word) => (/\d/.test(token) ? word === token : word.startsWith(token))),
  );
}

/**
 * One experiment: its figure, what it asks, and the buttons.
 * @param {Card} card
 * @param {{ watch: (engine: EngineName) => void, trials: (engine: EngineName) => void }} actions
 */
function cardOf(card, { watch, trials }) {
  const engine = make("select", { title: "By whose rules", ariaLabel: `Engine for ${card.title}` });
  engine.append(...card.engines.map((name) => new Option(engineWords(name), name)));
  engine.value = firstEngine(card);
  const chosen = () => /** @type {EngineName} */ (engine.value);
  const go = make("button", { type: "button", className: "go", ariaLabel: `Watch it: ${card.title}` });
  go.append(icon("play"), "Watch it");
  go.addEventListener("click", () => watch(chosen()));
  const more = make("button", { type: "button", className: "trials", textContent: "Trials" });
  more.ariaLabel = `Trials of ${card.title}`;
  more.addEventListener("click", () => trials(chosen()));
  const row = make("div", { className: "row" }, ...(card.engines.length > 1 ? [engine] : []), go, more);
  const made = make(
    "li",
    { className: "card" },
    figureOf(card),
    make("h3", { textContent: card.title }),
    make("p", { className: "second", textContent: `${sourceWords(card.paper)} · ${card.world}` }),
    make("p", { className: "asks", textContent: card.asks }),
    make("p", { className: "second facts", textContent: facts(card) }),
    row,
  );
  made.dataset.name = card.name;
  return made;
}

/** @param {Card} card */
function figureOf({ picture, plan, title }) {
  const figure = make("div", { className: "figure" });
  if (picture) figure.append(make("img", { src: picture, alt: `Figure: ${title}`, loading: "lazy" }));
  else if (plan) figure.append(planOf(plan));
  figure.classList.toggle("drawn", !picture);
  return figure;
}

export class Gallery {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {() => Promise<boolean>} mayLeave whether unsaved changes of the office may be lost
   */
  constructor(link, mayLeave) {
    this.link = link;
    this.mayLeave = mayLeave;
    this.dialog = $("gallery-dialog");
    this.grid = new Grid((wish) => this.watch(wish));
    /** @type {Card[]} */
    this.cards = [];
    this.from = ""; // the experiment whose trials were looked at
    this.begins = ""; // the experiment that was asked for and has not begun yet
    this.doing = ""; // what is going on before the engine's first tick
    $("gallery-close").addEventListener("click", () => this.dialog.close());
    $("gallery-back").addEventListener("click", () => this.back());
    $("gallery-search").addEventListener("input", () => this.search());
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
  }

  /** @param {Trial | null} [of] shows its experiment, at its setting */
  async open(of = null) {
    if (this.dialog.open) return;
    this.dialog.showModal();
    this.page(null);
    if (!this.cards.length) $("gallery-none").textContent = "Looking what there is …";
    const cards = await this.ask("/api/experiments");
    if (!cards) return;
    this.cards = cards;
    $("gallery-none").textContent = cards.length ? "" : "There are no experiments here.";
    const made = this.cards.map((card) =>
      cardOf(card, {
        watch: (engine) => this.watch({ type: "watch_experiment", experiment: card.name, engine }),
        trials: (engine) => this.show(card, engine),
      }),
    );
    $("gallery-cards").replaceChildren(...made);
    this.search();
    const card = of && this.cards.find(({ name }) => name === of.experiment);
    if (card) await this.show(card, of.engine, of.levels);
  }

  /** Leave the cards that have what is searched for. */
  search() {
    const wanted = /** @type {HTMLInputElement} */ ($("gallery-search")).value;
    const there = this.cards.filter((card) => matches(card, wanted)).map(({ name }) => name);
    for (const card of $("gallery-cards").querySelectorAll("li"))
      card.hidden = !there.includes(card.dataset.name ?? "");
    if (this.cards.length)
      $("gallery-none").textContent = there.length ? "" : "No experiment says this. Try a figure, a paper or a place.";
  }

  /** @param {Card} card @param {EngineName} engine @param {string[]} [levels] */
  async show(card, engine, levels) {
    const detail = await this.ask(`/api/experiments/${card.name}`);
    if (!detail) return;
    this.from = card.name;
    this.page(card.title);
    this.grid.show(detail, engine, levels);
    $("gallery-back").focus();
  }

  back() {
    this.page(null);
    /** @type {HTMLElement | null} */
    const came = this.dialog.querySelector(`[data-name="${this.from}"] .trials`);
    came?.focus();
  }

  /** Show the trials of one experiment, or all experiments. @param {string | null} title */
  page(title) {
    this.wrong("");
    $("gallery-title").textContent = title ?? "Experiments";
    $("gallery-all").hidden = title !== null;
    $("gallery-one").hidden = $("gallery-back").hidden = title === null;
    this.dialog.scrollTop = 0;
  }

  /** @param {WatchExperiment} wish */
  async watch(wish) {
    if (this.begins || !(await this.mayLeave())) return;
    const title = this.cards.find(({ name }) => name === wish.experiment)?.title ?? wish.experiment;
    this.begins = title;
    const slow = setTimeout(() => this.waking(this.doing), 400);
    const answer = await this.link.ask(wish, { quiet: true });
    clearTimeout(slow);
    this.begins = "";
    this.waits("");
    if (!answer.accepted) {
      this.wrong(answer.detail.length ? reasons(answer) : "The connection is lost; nothing was begun.");
      return;
    }
    this.dialog.close();
    toast(
      wish.moment_s === undefined ? `Watching: ${title}.` : `Seed ${wish.seed}: going to the moment that decided it.`,
    );
  }

  /** What is going on before the engine's first tick; "" after it. @param {string} doing */
  waking(doing) {
    this.doing = doing;
    if (this.begins) this.waits(doing ? `First the engine wakes up: ${doing}.` : "It begins in a moment.");
  }

  /** @param {string} words */
  waits(words) {
    $("gallery-wait").hidden = !words;
    $("gallery-wait").textContent = words && `“${this.begins}” was asked for. ${words}`;
  }

  /** What the server has at this address; null, and a sentence, if nothing can be had. @param {string} path */
  async ask(path) {
    const { data, wrong } = await get(path);
    if (!wrong) return data;
    this.wrong(wrong);
    $("gallery-none").textContent = "";
    return null;
  }

  /** @param {string} words */
  wrong(words) {
    $("gallery-wrong").hidden = !words;
    $("gallery-wrong").textContent = words && sentence(words);
  }
}

/**
 * What the note on the stage says of a trial that is being watched.
 * @param {Trial} trial
 * @param {number} time_s
 */
export function trialWords(trial, time_s) {
  const settings = [engineWords(trial.engine), ...trial.levels, `seed ${trial.seed}`].join(" · ");
  const which = trial.title;
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

/** The note on the stage about the trial that is being watched. */
export class Watched {
  /** @param {{ here: () => void, again: (wish: WatchExperiment) => void, more: (trial: Trial | null) => void }} actions */
  constructor({ here, again, more }) {
    this.box = $("trial");
    /** @type {Trial | null} */
    this.trial = null;
    this.run = -1;
    this.away = -1; // the run whose note was put away
    $("trial-here").addEventListener("click", here);
    $("trial-more").addEventListener("click", () => more(this.trial));
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

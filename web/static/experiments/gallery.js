// The experiments of the papers in a dialog: all of them as cards, or one with its trials.

import { $ } from "../ui/elements.js";
import { toast } from "../ui/toasts.js";
import { sentence } from "../ui/words.js";
import { get, reasons } from "../net/post.js";
import { cardOf } from "./card.js";
import { Grid } from "./grid.js";

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
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
  }

  async open() {
    if (this.dialog.open) return;
    this.wrong("");
    this.page(null);
    this.dialog.showModal();
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
  }

  /** @param {Card} card @param {EngineName} engine */
  async show(card, engine) {
    const detail = await this.ask(`/api/experiments/${card.name}`);
    if (!detail) return;
    this.from = card.name;
    this.page(card.title);
    this.grid.show(detail, engine);
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
    const { told, wrong } = await get(path);
    if (!wrong) return told;
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

// All lessons in a dialog, chapter by chapter, and which of them have been gone through in this browser. A click begins one.

import { $, find, icon, keep, kept, make } from "../ui/elements.js";
import { get, reasons } from "../net/post.js";
import { sentence, sourceWords } from "../ui/words.js";

/** Each begins with the lesson named here; those behind it belong to it, too. */
const GROUPS = new Map([
  ["packet", "The packet: path integration"],
  ["loop", "The map: loops, snaps, places"],
  ["kidnapped", "Lost and found"],
  ["goal", "Going somewhere"],
  ["small", "Limits, and what we added"],
]);

/**
 * Lessons in their order, by chapter. Those of the user's own come last.
 * @param {LessonCard[]} cards
 */
export function chapters(cards) {
  /** @type {{ title: string, cards: LessonCard[] }[]} */
  const all = [];
  for (const card of cards.filter(({ own }) => !own)) {
    const title = GROUPS.get(card.name);
    if (title || !all.length) all.push({ title: title ?? "Lessons", cards: [] });
    all[all.length - 1].cards.push(card);
  }
  const own = cards.filter((card) => card.own);
  return own.length ? [...all, { title: "Your own", cards: own }] : all;
}

/** The lesson after this one, in their order; null after the last. @param {LessonCard[]} cards @param {string} name */
export function nextAfter(cards, name) {
  const good = cards.filter(({ wrong }) => wrong === null);
  const at = good.findIndex((card) => card.name === name);
  return at < 0 ? null : (good[at + 1] ?? null);
}

/** @param {LessonCard} card */
export function cardFacts({ paper, minutes, rounds }) {
  const long = minutes < 1.5 ? `${Math.max(5, 5 * Math.round(minutes * 12))} s` : `${Math.round(minutes)} min`;
  return `${sourceWords(paper)} · ${long}${rounds > 1 ? ` · ${rounds} rounds` : ""}`;
}

/** The name of a lesson in an address, `#lesson=NAME`; null without one. @param {string} hash */
export const linked = (hash) => /^#lesson=([a-z0-9-]{1,40})$/.exec(hash)?.[1] ?? null;

export class LessonList {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {() => Promise<boolean>} mayLeave whether unsaved changes of the office may be lost
   */
  constructor(link, mayLeave) {
    this.link = link;
    this.mayLeave = mayLeave;
    this.dialog = $("lessons-dialog");
    /** @type {LessonCard[]} */
    this.cards = [];
    $("lessons-close").addEventListener("click", () => this.dialog.close());
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
  }

  async open() {
    if (this.dialog.open) return;
    this.wrong("");
    this.draw();
    this.dialog.showModal();
    await this.look();
    this.draw();
  }

  /** What there is. */
  async look() {
    const { data, wrong } = await get("/api/lessons");
    this.cards = data ?? this.cards;
    if (wrong) this.wrong(wrong);
    return this.cards;
  }

  draw() {
    const gone = done();
    const drawn = chapters(this.cards).map(({ title, cards }) => [
      make("h3", { textContent: title }),
      make("ul", {}, ...cards.map((card) => this.row(card, gone.includes(card.name)))),
    ]);
    $("lessons-list").replaceChildren(...drawn.flat());
  }

  /** @param {LessonCard} card @param {boolean} gone */
  row(card, gone) {
    const tick = gone ? [make("span", { className: "gone-through" }, icon("check"), "done")] : [];
    const button = make(
      "button",
      { type: "button", className: "lesson-card", disabled: card.wrong !== null },
      make("span", { className: "number", textContent: card.own ? "·" : String(card.number) }),
      make("b", { textContent: card.title }),
      make("span", { className: "idea", textContent: card.wrong ?? card.idea }),
      make("span", { className: "second" }, cardFacts(card), ...tick),
    );
    button.dataset.name = card.name;
    button.addEventListener("click", () => this.begin(card.name));
    return make("li", {}, button);
  }

  /** Also from an address or another lesson. @param {string} name */
  async begin(name) {
    if (!(await this.mayLeave())) return;
    this.wrong("");
    const answer = await this.link.ask({ type: "begin_lesson", name }, { quiet: this.dialog.open });
    if (answer.accepted) {
      this.dialog.close();
      if (find(document, "header").classList.contains("open")) $("more").click(); // on a phone it would cover the lesson
    } else this.wrong(answer.detail.length ? reasons(answer) : "The connection is lost; nothing was begun.");
  }

  /** @param {string} words */
  wrong(words) {
    $("lessons-wrong").hidden = !words;
    $("lessons-wrong").textContent = words && sentence(words);
  }
}

const DONE = "lessons done";

/** @returns {string[]} */
function done() {
  try {
    const names = JSON.parse(kept(DONE) ?? "[]");
    return Array.isArray(names) ? names.map(String) : [];
  } catch {
    return []; // it is no list of ours
  }
}

/** @param {string} name */
export function setDone(name) {
  keep(DONE, JSON.stringify([...new Set([...done(), name])]));
}

// All lessons in a dialog, chapter by chapter. A click begins one.

import { $, find, icon, make } from "../ui/elements.js";
import { cardFacts, chapters } from "../model/lessons.js";
import { get, reasons } from "../net/post.js";
import { sentence } from "../ui/words.js";
import { done } from "./kept.js";

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
    const { told, wrong } = await get("/api/lessons");
    this.cards = told ?? this.cards;
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

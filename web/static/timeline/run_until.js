// "Until": runs as fast as it can until something happens, and stops at that very tick.

import { $, make, renew, say } from "../ui/elements.js";
import { toast } from "../ui/words.js";

/** @type {{ words: string, wish: Omit<RunUntil, "type"> }[]} */
export const CHOICES = [
  { words: "a loop closes", wish: { what: "closure" } },
  { words: "it is lost", wish: { what: "lost" } },
  { words: "it knows again where it is", wish: { what: "found again" } },
  { words: "the packet snaps", wish: { what: "snap" } },
  { words: "it is at its goal", wish: { what: "goal reached" } },
];

/** So many packets can be waited for. */
const PACKETS = { least: 2, most: 9 };

/** What is said when it has happened; null while it runs, and if it was broken off. A warning says that it came too late. @param {UntilView} until */
export const ending = ({ state, words }) => (state === "met" ? `Stopped at this very tick: ${words}.` : null);

/** @typedef {Omit<RunUntil, "type">} Wish */

export class RunUntilMenu {
  /**
   * @param {(wish: Command) => Promise<boolean>} command
   * @param {() => boolean} shownElsewhere whether somebody else shows that it runs, and says what comes of it
   */
  constructor(command, shownElsewhere) {
    this.shownElsewhere = shownElsewhere;
    /** @type {UntilView["state"] | null} */
    this.state = null;
    this.command = command;
    const { least, most } = PACKETS;
    this.count = make("input", { type: "number", value: String(least), min: String(least), max: String(most) });
    this.count.setAttribute("aria-label", "How many packets");
    this.place = make("select", { ariaLabel: "Which place" });
    this.comes = this.row("it comes to", this.place, () => ({ what: "place", place: this.place.value }));
    const packets = this.row("packets compete:", this.count, () => ({
      what: "packets",
      count: this.count.valueAsNumber,
    }));
    $("until-list").replaceChildren(
      ...CHOICES.map(({ words, wish }) => this.button(words, () => wish)),
      packets,
      this.comes,
    );
    $("until-open").addEventListener("click", () => this.show($("until-box").hidden === true));
    $("until-cancel").addEventListener("click", () => command({ type: "pause" }));
    window.addEventListener("pointerdown", ({ target }) => {
      const inside = [$("until-box"), $("until-open")].some((part) => part.contains(/** @type {Node} */ (target)));
      if (!inside) this.show(false);
    });
  }

  /** @param {string} words @param {() => Wish} wish */
  button(words, wish) {
    const button = make("button", { type: "button", textContent: words });
    button.addEventListener("click", async () => {
      this.show(false);
      $("until-open").focus();
      await this.command({ type: "run_until", ...wish() });
    });
    return button;
  }

  /** A choice with something to fill in. @param {string} words @param {HTMLElement} field @param {() => Wish} wish */
  row(words, field, wish) {
    return make("div", { className: "until-row" }, this.button(words, wish), field);
  }

  /** @param {State} state @param {PageFields["places"]} places of the office, by name */
  at({ until }, places) {
    const names = places.map(([name]) => name);
    this.comes.hidden = !names.length;
    renew(this.place, names, () => names.map((name) => make("option", { value: name, textContent: name })));
    const before = this.state;
    this.state = until?.state ?? null;
    $("until").hidden = until?.state !== "running" || this.shownElsewhere();
    if (!until) return;
    say($("until-words"), until.words);
    $("until-done").value = until.progress;
    const end = before === "running" ? ending(until) : null;
    if (end && !this.shownElsewhere()) toast(end, { notice: true });
  }

  /** @param {boolean} on */
  show(on) {
    $("until-box").hidden = !on;
    $("until-open").setAttribute("aria-expanded", String(on));
  }

  /** True when it was open. */
  close() {
    if ($("until-box").hidden) return false;
    this.show(false);
    $("until-open").focus();
    return true;
  }
}

// Two brains on the same senses: a menu of the second ones, and a strip on the stage that says how the two differ.

import { $, find, make, renew } from "../ui/elements.js";
import { cellsOf, changedWords, HEADS, MEANS, odometryWords, sinceWhen, valueWords } from "../model/beside.js";
import { AdditionChoice } from "./additions.js";

export class BesideStrip {
  /** @param {(wish: Command, done?: string) => Promise<boolean>} command */
  constructor(command) {
    this.command = command;
    this.told = "";
    this.additions = new AdditionChoice((pair, since) => this.begin(pair, since));
    $("beside-heads").append(
      ...HEADS.map((text) => make("th", { scope: "col", textContent: text, title: MEANS[text] ?? "" })),
    );
    $("beside-end").addEventListener("click", () => this.command({ type: "end_comparison" }));
  }

  /** @param {PairChoice} pair */
  choice({ name, title, about, since }) {
    const small = since === "beginning" ? [make("small", { textContent: about })] : [];
    const button = make("button", { type: "button" }, make("span", { textContent: title }), ...small);
    button.dataset.key = name;
    button.addEventListener("click", () => this.begin(name, since));
    return button;
  }

  /** @param {string} pair @param {"beginning" | "now"} since */
  begin(pair, since) {
    $("brains").open = false;
    this.command({ type: "compare_brains", pair, since }, "Two brains, the same senses. The first one drives.");
  }

  /**
   * @param {BesideFields | null} beside
   * @param {PairChoice[]} pairs what could be compared with the first brain
   * @param {AdditionsOff} off our additions that it lacks
   */
  show(beside, pairs, off) {
    this.additions.show(off);
    for (const [since, id] of /** @type {const} */ ([
      ["beginning", "brains-anew"],
      ["now", "brains-now"],
    ])) {
      const offered = pairs.filter((pair) => pair.since === since);
      renew($(id), offered, () => offered.map((pair) => this.choice(pair)));
    }
    $("beside").hidden = beside === null;
    document.body.dataset.beside = String(beside !== null);
    find(document, "button[data-view='all']").textContent = beside ? "Both" : "All";
    if (!beside) return;
    ["first", "second"].forEach((which, k) => {
      const brain = k === 0 ? beside.first : beside.second;
      const row = /** @type {HTMLTableRowElement} */ ($(k === 0 ? "beside-first" : "beside-second"));
      const cells = [brain.name, ...cellsOf(brain)];
      while (row.cells.length < cells.length) row.append(make("td", { className: which }));
      for (const [at, text] of cells.entries()) say(row.cells[at], text);
    });
    say($("beside-odometry"), odometryWords(beside));
    this.showDifferences(beside.differences);
    renew($("beside-values"), [beside.first.name, beside.second.name, beside.changed], () => this.values(beside));
  }

  /** Each parameter in which they differ, and its value in both. @param {BesideFields} beside */
  values({ first, second, changed }) {
    const summary = find($("beside-changed"), "summary");
    const { button, title } = changedWords(changed);
    [summary.textContent, /** @type {HTMLElement} */ (summary).title] = [button, title];
    const heads = find($("beside-changed"), "thead tr");
    const named = [first.name, second.name].map((text) => make("th", { scope: "col", textContent: text }));
    heads.replaceChildren(heads.children[0], ...named);
    return changed.map(({ name, ...values }) => {
      const cells = [values.first, values.second].map((value) => make("td", { textContent: valueWords(value) }));
      return make("tr", {}, make("th", { scope: "row", textContent: name }), ...cells);
    });
  }

  /** @param {DifferenceFields[]} differences */
  showDifferences(differences) {
    const told = JSON.stringify(differences);
    if (told === this.told) return;
    this.told = told;
    say($("beside-since"), differences.length ? "They differ since:" : "No difference yet.");
    $("beside-differences").replaceChildren(
      ...differences.map((difference) => {
        const { button, title } = sinceWhen(difference);
        const made = make("button", { type: "button", className: "tiny", textContent: button, title });
        made.setAttribute("aria-label", `${button}. ${title}`);
        const tick = Math.max(1, difference.tick); // at the end of tick 0 the second brain had not begun
        made.addEventListener("click", () => this.command({ type: "seek", tick }));
        return made;
      }),
    );
  }
}

/** @param {Element} place @param {string} words */
function say(place, words) {
  if (place.textContent !== words) place.textContent = words;
}

// The help: what the plates show, and every key by group, written from the table by which the page acts.

import { $ } from "../elements/dom.js";
import { make } from "../elements/elements.js";
import { GROUPS, written } from "../model/key_table.js";

const DRIVING = { keys: ["↑", "←", "↓", "→", "W", "A", "S", "D"], words: "drive while held" };

export class Help {
  constructor() {
    this.dialog = $("help-dialog");
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.toggle());
    $("help-close").addEventListener("click", () => this.toggle());
    $("keys").replaceChildren(...GROUPS.map(groupOf));
  }

  toggle() {
    if (this.dialog.open) this.dialog.close();
    else this.dialog.showModal();
  }
}

/** @param {import("../model/key_table.js").Group} group */
function groupOf({ title, rows }) {
  const all = title === "Robot" ? [DRIVING, ...rows] : rows;
  return make(
    "section",
    {},
    make("h4", { textContent: title }),
    make(
      "ul",
      {},
      ...all.map(({ keys, words }) =>
        make("li", {}, ...keys.map((key) => make("kbd", { textContent: written(key) })), ` ${words}`),
      ),
    ),
  );
}

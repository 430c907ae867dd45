// The help: what the plates show, and every key by group, written from the table by which the page acts.

import { $, make } from "../ui/elements.js";
import { DRIVING, GROUPS, written } from "../driving/keys.js";

const ARROWS = ["↑", "←", "↓", "→"];

export class Help {
  constructor() {
    this.dialog = $("help-dialog");
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.toggle());
    $("help-close").addEventListener("click", () => this.toggle());
    this.write(["w", "a", "s", "d"]);
    this.writeLayout();
  }

  /** With what this keyboard writes on the keys that drive, where the browser tells. */
  async writeLayout() {
    const { keyboard } = /** @type {{ keyboard?: { getLayoutMap(): Promise<Map<string, string>> } }} */ (navigator);
    const layout = await keyboard?.getLayoutMap().catch(() => undefined); // not in a frame, or not allowed
    if (layout?.size) this.write(DRIVING.map((code) => layout.get(code) ?? code[3].toLowerCase()));
  }

  /** @param {string[]} driving what is written on the four keys that drive */
  write(driving) {
    $("keys").replaceChildren(...GROUPS.map((group) => groupOf(group, driving)));
    $("drive-keys").textContent = driving.join("").toUpperCase();
  }

  toggle() {
    if (this.dialog.open) this.dialog.close();
    else this.dialog.showModal();
  }
}

/** @param {import("../driving/keys.js").Group} group @param {string[]} driving */
function groupOf({ title, rows }, driving) {
  const drive = { keys: [...ARROWS, ...driving], words: "drive while held" };
  const all = title === "Robot" ? [drive, ...rows] : rows;
  return make(
    "section",
    {},
    make("h4", { textContent: title }),
    make(
      "ul",
      {},
      ...all.map(({ keys, words }) =>
        make(
          "li",
          {},
          ...keys.map((key) =>
            make("kbd", { textContent: (words !== drive.words && driving.includes(key) ? "⇧" : "") + written(key) }),
          ),
          ` ${words}`,
        ),
      ),
    ),
  );
}

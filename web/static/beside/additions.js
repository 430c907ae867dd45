// A second brain without one of our additions, or with it if the first one lacks it: chosen by name, with what it is good for.

import { $, make, renew, say } from "../ui/elements.js";
import { additionChoice, additionGroups } from "../model/additions.js";

export class AdditionChoice {
  /** @param {(name: string, since: "beginning" | "now") => void} begin */
  constructor(begin) {
    /** @type {AdditionsOff} */
    this.off = { beginning: [], now: [] };
    this.select = $("brains-addition");
    this.select.addEventListener("change", () => this.explain());
    $("brains-addition-anew").addEventListener("click", () => begin(this.select.value, "beginning"));
    $("brains-addition-now").addEventListener("click", () => begin(this.select.value, "now"));
  }

  /** @param {AdditionsOff} off */
  show(off) {
    this.off = off;
    const chosen = this.select.value;
    renew(this.select, off, () =>
      additionGroups(off).map(({ label, names }) =>
        make("optgroup", { label }, ...names.map((value) => make("option", { value, textContent: value }))),
      ),
    );
    if (chosen) this.select.value = chosen;
    this.explain();
  }

  explain() {
    const { about, anew, now } = additionChoice(this.select.value, this.off);
    say($("brains-about"), about);
    say($("brains-addition-anew"), anew);
    say($("brains-addition-now"), now);
    $("brains-addition-now").hidden = now === "";
  }
}

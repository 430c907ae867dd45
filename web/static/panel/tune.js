// Tune: every parameter, by group; a search finds it by any of its words.

import { make, say } from "../ui/elements.js";
import { grouped, means } from "../model/knobs.js";
import { Knob } from "./knob.js";

/** @typedef {import("../model/knobs.js").Parameter} Parameter */

const POINT = "Point at a name, or touch or tab to its field, for its meaning. ↻ takes effect at reset.";

export class TuneTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.ask = ask;
    this.search = make("input", {
      type: "search",
      placeholder: "Search: name, symbol, unit, meaning",
      autocomplete: "off",
    });
    this.search.setAttribute("aria-label", "Search the parameters");
    this.search.addEventListener("input", () => this.find());
    this.found = make("p", { className: "quiet" });
    this.found.setAttribute("role", "status");
    this.groups = make("div");
    this.hint = make("p", { className: "hint", textContent: POINT });
    this.hint.setAttribute("aria-hidden", "true"); // each control has a description of its own
    const head = make("div", { className: "search" }, this.search, this.found);
    this.box = make("div", { className: "tune" }, head, this.groups, this.hint);
    for (const kind of /** @type {const} */ (["pointerover", "focusin"]))
      this.groups.addEventListener(kind, (event) => this.explain(/** @type {Element} */ (event.target)));
    /** @type {Map<string, Knob>} */
    this.knobs = new Map();
    this.sought = ""; // which one is to have the focus as soon as it is there
  }

  /** @param {{ knobs: Parameter[] }} data */
  tune({ knobs }) {
    if (String(knobs.map(({ name }) => name)) !== String([...this.knobs.keys()])) this.build(knobs);
    for (const parameter of knobs) this.knobs.get(parameter.name)?.show(parameter);
  }

  /** @param {Parameter[]} parameters */
  build(parameters) {
    this.knobs = new Map(parameters.map((parameter) => [parameter.name, new Knob(parameter, this.ask)]));
    const drawn = [...grouped(parameters)].map(([group, members], k) => {
      const boxes = members.flatMap(({ name }) => this.knobs.get(name)?.box ?? []);
      return make("details", { open: k === 0 }, make("summary", { textContent: group }), ...boxes);
    });
    this.groups.replaceChildren(...drawn);
    this.find();
    if (this.sought && document.activeElement === this.search) this.at(this.sought);
    this.sought = "";
  }

  /** Shows what the search finds; without a search, groups are open or closed as people left them. */
  find() {
    const search = this.search.value.trim();
    let count = 0;
    for (const { parameter, box } of this.knobs.values()) {
      box.hidden = !means(parameter, search);
      count += Number(!box.hidden);
    }
    for (const group of this.groups.querySelectorAll("details")) {
      group.hidden = !group.querySelector(".knob:not([hidden])");
      if (search) {
        group.dataset.was ??= String(group.open);
        group.open = true;
      } else if (group.dataset.was) {
        group.open = group.dataset.was === "true";
        delete group.dataset.was;
      }
    }
    const words = count === 1 ? "1 parameter" : `${count} parameters`;
    say(this.found, search ? (count ? words : `nothing is called “${search}”`) : words);
  }

  /** Shows one parameter alone, and puts the focus on it. @param {string} name */
  at(name) {
    this.search.value = name;
    this.find();
    const knob = this.knobs.get(name);
    if (!knob) this.sought = name;
    (knob?.input ?? this.search).focus();
  }

  /** @param {string} name */
  valueOf(name) {
    const value = this.knobs.get(name)?.parameter.value;
    return value === undefined ? null : String(value);
  }

  /** @param {Element} target */
  explain(target) {
    const box = target.closest(".knob");
    const knob = [...this.knobs.values()].find((one) => one.box === box);
    if (knob) say(this.hint, knob.parameter.hint);
  }

  get parts() {
    return { tune: this.tune.bind(this) };
  }
}

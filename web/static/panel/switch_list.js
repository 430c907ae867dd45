// The switches of one tab that all pages share (web/switches.py).

import { make } from "../ui/elements.js";

/** @typedef {{ name: string, tab: string, words: string, hint: string, on: boolean }} Switch */

export class SwitchList {
  /** @param {string} tab @param {import("./panel.js").Ask} ask */
  constructor(tab, ask) {
    Object.assign(this, { tab });
    this.tab = tab;
    this.ask = ask;
    this.box = make("div", { className: "switches" });
    /** @type {Map<string, HTMLInputElement>} */
    this.inputs = new Map();
  }

  /** @param {{ switches: Switch[] }} data */
  show({ switches }) {
    for (const of of switches.filter(({ tab }) => tab === this.tab)) {
      const input = this.inputs.get(of.name) ?? this.add(of);
      input.checked = of.on;
    }
  }

  /** @param {Switch} of */
  add({ name, words, hint }) {
    const input = make("input", { type: "checkbox" });
    input.addEventListener("change", () => this.ask({ type: "switch", name, on: input.checked }));
    this.box.append(make("label", { className: "check", title: hint }, input, make("span", { textContent: words })));
    this.inputs.set(name, input);
    return input;
  }
}

// Tabs for the keyboard: one of them is in the tab order, and the arrows go from one to the next.

import { make } from "../ui/elements.js";

export class TabList {
  /** @param {readonly string[]} names @param {(name: string) => void} chosen by a person */
  constructor(names, chosen) {
    this.chosen = chosen;
    this.tabs = new Map(names.map((name) => [name, this.tab(name)]));
    this.box = make("div", { className: "tabs" }, ...this.tabs.values());
    this.box.setAttribute("role", "tablist");
    this.box.setAttribute("aria-label", "Panel");
    this.box.addEventListener("keydown", (event) => this.pressed(event));
  }

  /** @param {string} name */
  tab(name) {
    const tab = make("button", { type: "button", id: `tab-${name.toLowerCase()}`, textContent: name });
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", `panel-${name.toLowerCase()}`);
    tab.addEventListener("click", () => this.chosen(name));
    return tab;
  }

  /** @param {string} name */
  select(name) {
    for (const [other, tab] of this.tabs) {
      tab.setAttribute("aria-selected", String(other === name));
      tab.tabIndex = other === name ? 0 : -1;
    }
    this.tabs.get(name)?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  /** @param {string[]} names */
  hide(names) {
    for (const [name, tab] of this.tabs) tab.hidden = names.includes(name);
  }

  /** @param {KeyboardEvent} event */
  pressed(event) {
    const names = [...this.tabs.keys()].filter((name) => !this.tabs.get(name)?.hidden);
    const now = names.findIndex((name) => this.tabs.get(name) === event.target);
    /** @type {Record<string, number>} */
    const places = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: names.length - 1 };
    if (now < 0 || !(event.key in places)) return;
    event.preventDefault();
    const name = names[(places[event.key] + names.length) % names.length];
    this.chosen(name);
    this.tabs.get(name)?.focus();
  }
}

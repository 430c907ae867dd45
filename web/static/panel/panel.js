// The side panel: seven tabs, of which one is open. What it shows comes over the page's stream, for the open tab alone.

import { icon, labelled, make } from "../ui/elements.js";
import { InspectTab } from "./inspect.js";
import { MemoryTab } from "./memory.js";
import { OfficeTab } from "./office.js";
import { SensesTab } from "./senses.js";
import { TickTab } from "./tick.js";
import { TruthTab } from "./truth.js";
import { TuneTab } from "./tune.js";

/** Tabs for the keyboard: one of them is in the tab order, and the arrows go from one to the next. */
class TabList {
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
    tab.dataset.from = FROM[name];
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
    const names = [...this.tabs.keys()].filter((name) => this.tabs.get(name)?.checkVisibility());
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

/** From which level on a tab is there. @type {Record<string, import("../ui/levels.js").Level>} */
const FROM = {
  Senses: "explore",
  Memory: "explore",
  Truth: "explore",
  Office: "explore",
  Inspect: "lab",
  Tick: "lab",
  Tune: "lab",
};

/**
 * @typedef {(command: Command | PageMessage) => Promise<Answer>} Ask
 * @typedef {import("./senses.js").Arrays} Arrays
 * @typedef {Record<string, (data: any, arrays: Arrays) => void>} Parts
 * @typedef {{ part: string, data: any, has: string[], arrays?: Arrays }} Message
 */

const EVERY_MS = 150; // the server takes ten messages a second
const LATE_STATES = 3; // that may have been on their way when a choice was answered

export class Panel {
  /**
   * @param {HTMLElement} box
   * @param {import("../net/connection.js").Connection} link
   * @param {(text: string) => void} complain
   * @param {import("../ui/levels.js").Levels} levels
   */
  constructor(box, link, complain, levels) {
    const narrow = window.matchMedia("(max-width: 1000px)"); // there the panel is a sheet over the plates
    this.box = box;
    this.link = link;
    this.levels = levels;
    /** @type {Ask} */
    const ask = (command) => link.ask(command);
    this.awaited = 0; // states that may still bring what was chosen on this page
    const inspect = (/** @type {Record<string, number>} */ wish) => void this.awaits(ask({ type: "inspect", ...wish }));
    this.truth = new TruthTab(ask);
    this.tuning = new TuneTab(ask);
    /** @type {Record<string, { box: HTMLElement, parts: Parts }>} */
    this.views = {
      Senses: new SensesTab(inspect),
      Memory: new MemoryTab(ask),
      Inspect: new InspectTab(ask, complain),
      Tick: new TickTab(ask),
      Truth: this.truth,
      Office: new OfficeTab(ask),
      Tune: this.tuning,
    };
    /** @type {Map<string, HTMLElement>} what each tab opens */
    this.panels = new Map();
    this.tabs = new TabList(Object.keys(this.views), (name) => this.open(name));
    /** @type {Map<string, Message>} the last message of each part, with all its arrays */
    this.received = new Map();
    /** @type {string | null | undefined} */
    this.looked = undefined;
    this.opened = "Senses";
    this.next_ms = 0;
    this.later = 0;
    this.shown = !narrow.matches && levels.has("explore");
    this.build();
    this.open("Senses");
    this.show(this.shown);
    const fits = () => !narrow.matches && document.body.dataset.presenter !== "true" && levels.has("explore");
    narrow.addEventListener("change", () => this.show(fits()));
    levels.addEventListener("level", (event) =>
      this.levelled(/** @type {CustomEvent} */ (event).detail.before, fits()),
    );
    document.addEventListener("visibilitychange", () => this.sendTabs());
    link.on("hello", () => {
      this.received.clear(); // a new connection: the server sends everything again
      this.sendTabs();
    });
    link.on("panel", (/** @type {Message} */ message) => this.take(message));
    new MutationObserver(() => this.recolour()).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  }

  build() {
    const close = labelled(
      "Hide the panel (p)",
      make("button", { type: "button", className: "bare close" }, icon("close")),
    );
    close.addEventListener("click", () => this.show(false));
    for (const [name, view] of Object.entries(this.views)) {
      // On a page that only looks on, a fieldset disables whatever there is to press or to set.
      const box = this.link.watches ? make("div", {}, make("fieldset", { disabled: true }, view.box)) : view.box;
      Object.assign(box, { id: `panel-${name.toLowerCase()}`, tabIndex: 0 });
      box.classList.add("tabpanel");
      box.setAttribute("role", "tabpanel");
      box.setAttribute("aria-labelledby", `tab-${name.toLowerCase()}`);
      this.panels.set(name, box);
    }
    this.box.append(make("div", { className: "head" }, this.tabs.box, close), ...this.panels.values());
  }

  /** Another level: the panel comes and goes with *Explore*, and its tabs with theirs. @param {string} before @param {boolean} fits */
  levelled(before, fits) {
    if (!this.levels.has("explore")) this.show(false);
    if (!this.levels.has(FROM[this.opened])) this.open("Senses");
    if (before === "watch" && fits) this.show(true);
  }

  /** @param {string} name */
  open(name) {
    this.opened = name;
    if (this.shown) this.levels.need(FROM[name]);
    this.tabs.select(name);
    for (const [other, box] of this.panels) box.hidden = other !== name;
    this.sendTabs();
  }

  /** Opens Tune at one parameter, as soon as it has come. @param {string} name */
  tune(name) {
    this.open("Tune");
    this.tuning.at(name);
  }

  /** The value of a parameter as it is now; null: not known here. @param {string} name */
  valueOf = (name) => this.tuning.valueOf(name);

  /** Hides the tabs that have nothing to show, and shows the others. @param {string[]} names */
  hide(names) {
    this.tabs.hide(names);
    if (names.includes(this.opened)) this.open("Senses");
  }

  /** @param {boolean} on */
  show(on) {
    this.shown = on;
    if (on) this.levels.need(FROM[this.opened]);
    document.body.dataset.panels = String(on);
    for (const button of document.querySelectorAll("[data-shows-panel]"))
      button.setAttribute("aria-expanded", String(on));
    this.sendTabs();
  }

  /** Tells the server which tab is open, none while the panel is hidden; not more often than every `EVERY_MS`. */
  sendTabs() {
    clearTimeout(this.later);
    const wait_ms = this.next_ms - performance.now();
    if (wait_ms > 0) {
      this.later = window.setTimeout(() => this.sendTabs(), wait_ms);
      return;
    }
    this.next_ms = performance.now() + EVERY_MS;
    this.link.send({ type: "tabs", names: this.shown && !document.hidden ? [this.opened] : [] });
  }

  /** @param {Message} message */
  take({ part, data, has, arrays = {} }) {
    const before = this.received.get(part)?.arrays ?? {};
    const whole = Object.fromEntries(has.map((name) => [name, arrays[name] ?? before[name]]));
    this.received.set(part, { part, data, has, arrays: whole });
    this.draw(part, data, whole);
  }

  /** @param {string} part @param {any} data @param {Arrays} arrays */
  draw(part, data, arrays) {
    for (const { parts } of Object.values(this.views)) parts[part]?.(data, arrays);
  }

  recolour() {
    const cells = this.received.get("cells");
    if (cells?.arrays) this.draw("cells", cells.data, cells.arrays);
    this.truth.recolour();
  }

  /** Something was chosen on this page; one of the next states shows it. @param {Promise<Answer>} answer */
  async awaits(answer) {
    this.awaited = Infinity;
    await answer;
    this.awaited = LATE_STATES;
  }

  /** Why something happened, by the number of its event. @param {number} event */
  why(event) {
    this.awaits(this.link.ask({ type: "inspect", event }));
  }

  /**
   * Opens the tab that tells about what was just chosen; a page that has just loaded keeps its tab, and one that shows less than all
   * is disturbed by its own choice only.
   * @param {string | null} name
   */
  inspected(name) {
    const before = this.looked;
    const own = this.awaited-- > 0;
    this.looked = name;
    if (name === null || before === undefined || name === before) return;
    const all = this.levels.has("lab");
    if (all || own) this.open("Inspect");
    if (!all && own) this.show(true);
  }
}

// All events as a list that can be filtered by kind; a click goes to that moment.

import { $, make, svg } from "../ui/elements.js";
import { clock } from "../ui/words.js";
import { nameOf } from "../model/event_kinds.js";
import { times } from "../model/timeline.js";
import { markAt } from "./events.js";

const MOST = 200; // rows

export class EventList {
  /** @param {import("./timeline.js").Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    /** @type {Set<string>} */
    this.hidden = new Set(); // kinds
    $("events-open").addEventListener("click", () => this.toggle());
    $("events-close").addEventListener("click", () => this.close());
  }

  /** The events whose kinds are not filtered out. */
  get shown() {
    return this.timeline.events.filter(({ kind }) => !this.hidden.has(kind));
  }

  get open() {
    return !$("events-box").hidden;
  }

  toggle() {
    $("events-box").hidden = this.open;
    $("events-open").setAttribute("aria-expanded", String(this.open));
    this.draw();
  }

  /** True when it was open. */
  close() {
    const was = this.open;
    if (was) {
      this.toggle();
      $("events-open").focus();
    }
    return was;
  }

  draw() {
    if (!this.open) return;
    const kinds = [...new Set(this.timeline.events.map(({ kind }) => kind))];
    $("event-kinds").replaceChildren(...kinds.map((kind) => this.filter(kind)));
    const rows = this.shown.slice(-MOST);
    $("events-count").textContent = `${this.shown.length} of ${this.timeline.events.length}`;
    $("event-list").replaceChildren(...rows.reverse().map((event) => this.row(event)));
  }

  /** @param {string} kind */
  filter(kind) {
    const button = make("button", { type: "button", className: "kind" }, picture(kind), nameOf(kind));
    button.dataset.kind = kind;
    button.setAttribute("aria-pressed", String(!this.hidden.has(kind)));
    button.addEventListener("click", () => {
      if (!this.hidden.delete(kind)) this.hidden.add(kind);
      this.draw();
      this.timeline.redraw(true);
      /** @type {HTMLElement | null} */ ($("event-kinds").querySelector(`[data-kind="${CSS.escape(kind)}"]`))?.focus();
    });
    return button;
  }

  /** @param {TimelineEvent} event */
  row(event) {
    const { kind, time_s, text } = event;
    const words = make("span", {}, make("b", { textContent: nameOf(kind) }), ` ${text}${times(event)}`);
    const button = make(
      "button",
      { type: "button" },
      make("time", { textContent: clock(time_s) }),
      picture(kind),
      words,
    );
    button.addEventListener("click", () => this.timeline.seeker.seek({ time_s }));
    return make("li", {}, button);
  }
}

/** @param {string} kind */
const picture = (kind) =>
  svg("svg", { viewBox: "-10 -10 20 20", class: "icon", "aria-hidden": "true" }, markAt(kind, 0, 0));

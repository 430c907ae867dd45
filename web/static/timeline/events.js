// Events: each kind has a name, a weight that decides when there is no room for all, and a mark. All of them are a list that can be
// filtered by kind; a click goes to that moment. The colours are in page.css. A kind that is not listed here is shown under its own name.

import { clock } from "../ui/words.js";
import { $, make, svg } from "../ui/elements.js";

/** @param {number} r */
const circle = (r) => `M${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;

/** @type {Record<EventKind, { name: string, weight: number, d: string, open?: boolean }>} */
const KINDS = {
  kidnap: { name: "kidnap", weight: 5, d: "M0-7l6 7-6 7-6-7z" },
  lost: { name: "lost", weight: 3, d: "M-5-5l10 10M5-5l-10 10", open: true },
  believes: { name: "believes", weight: 3, d: `${circle(5)}${circle(1)}`, open: true },
  joined: {
    name: "map joined",
    weight: 3,
    d: "M-7 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0M-1 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0",
    open: true,
  },
  corrected: { name: "map corrected", weight: 3, d: "M-6-3h12M-6 3h12M4-7l-8 14", open: true },
  recovered: { name: "recovered", weight: 3, d: circle(5), open: true },
  snap: { name: "snap", weight: 0, d: circle(5) },
  goal: { name: "goal set", weight: 4, d: "M-4 7v-15l10 4-8.4 4v7z" },
  arrived: { name: "arrived", weight: 4, d: "M-6 0l4 5 8-10", open: true },
  unreachable: { name: "no route", weight: 4, d: "M-5-5l10 10M5-5l-10 10", open: true },
  packet: { name: "packet put in", weight: 2, d: "M-5-5h10v10h-10z" },
  brain: { name: "brain", weight: 3, d: "M-5-5h10v10h-10z", open: true },
  office: { name: "office changed", weight: 1, d: "M0-6v12", open: true },
  parameter: { name: "setting", weight: 1, d: "M0-6v12M-3-6h6M-3 6h6", open: true },
  link: { name: "link lost", weight: 2, d: "M-4-4l8 8M-4 4l8-8", open: true },
  place: { name: "places", weight: 1, d: `${circle(5)}M-2 0h4`, open: true },
  false: { name: "false positive", weight: 1, d: circle(4) },
  warning: { name: "note", weight: 2, d: "M0-8l8 14h-16z", open: true },
  fault: { name: "fault", weight: 6, d: "M0-8l8 14h-16z" },
  trial: { name: "experiment", weight: 4, d: "M-5 7V-7M-5-6h10l-3 3 3 3h-10", open: true },
  tagged: { name: "place tagged", weight: 3, d: "M0 7l-5-8a5 5 0 1 1 10 0z", open: true },
  reached: { name: "reached", weight: 5, d: "M-6-6h12v12h-12zM-3 0l2 3 4-6", open: true },
  failed: { name: "failed", weight: 5, d: "M-6-6h12v12h-12zM-3-3l6 6M3-3l-6 6", open: true },
  closure: { name: "loop closed", weight: 2, d: "M5-3a6 6 0 1 0 0 6M5-3v-4M5-3h-4", open: true },
  explored: { name: "explored", weight: 4, d: `${circle(6)}M-3 0l2 3 4-6`, open: true },
  branch: { name: "branch", weight: 4, d: "M-4 7V-7M-4 3c0-6 8-3 8-10", open: true },
  recording: { name: "recording", weight: 5, d: "M-6-6v12M0-6v12M6-6v12M-6 0h12", open: true },
  lesson: { name: "lesson", weight: 5, d: "M-7-2l7-4 7 4-7 4zM-4 0v4c2 2 6 2 8 0v-4", open: true },
};
const UNKNOWN = { weight: 1, d: "M0-5l5 5-5 5-5-5z", open: true };

export const kinds = /** @type {EventKind[]} */ (Object.keys(KINDS));

/** @param {string} kind */
const known = (kind) => (Object.hasOwn(KINDS, kind) ? KINDS[/** @type {EventKind} */ (kind)] : null);

/** @param {string} kind */
export const nameOf = (kind) => known(kind)?.name ?? kind.replaceAll("_", " ");

/** @param {string} kind */
export const weightOf = (kind) => (known(kind) ?? UNKNOWN).weight;

/** The outline of a kind's mark, and whether it is only a line. @param {string} kind @returns {{ d: string, open?: boolean }} */
export const markOf = (kind) => known(kind) ?? UNKNOWN;

/** @param {TimelineEvent} event */
export const words = (event) => `${clock(event.time_s)} ${nameOf(event.kind)}: ${event.text}${times(event)}`;

/** How often what repeats has happened, "" for once. @param {Pick<TimelineEvent, "count" | "since_s">} event */
const times = ({ count, since_s }) => (count > 1 ? `, ${count} times since ${clock(since_s)}` : "");

/** Of what repeats only the newest, which counts the others. @param {TimelineEvent[]} events oldest first */
export function counted(events) {
  const newest = new Map(events.map((event) => [event.line, event]));
  return events.filter((event) => !event.line || newest.get(event.line) === event);
}

/** @param {string} kind @param {number} x @param {number} y */
export function markAt(kind, x, y) {
  const { d, open } = markOf(kind);
  return svg("path", { d, transform: `translate(${x} ${y})`, class: open ? "mark open" : "mark", "data-kind": kind });
}

// What the marks mean, for the help.
export function legend() {
  return kinds.map((kind) => {
    const item = document.createElement("li");
    item.append(
      svg("svg", { viewBox: "-10 -10 20 20", class: "icon", "aria-hidden": "true" }, markAt(kind, 0, 0)),
      nameOf(kind),
    );
    return item;
  });
}

const MOST = 200; // rows

/** All events as a list that can be filtered by kind; a click goes to that moment. */
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

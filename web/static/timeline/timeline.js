// The timeline: events as marks of different shape and colour, with names where there is room. Marks that are pointed at or
// touched say more.

import { $ } from "../elements/dom.js";
import { make } from "../elements/elements.js";
import { legend, markAt } from "./events.js";
import { svg } from "../elements/icons.js";
import { clock, tickTimes } from "../model/clock.js";
import { nameOf } from "../model/event_kinds.js";
import { labelsOf, marksOf, words } from "../model/timeline.js";

const REDRAW_MS = 500;
const MOST = 500; // events, as the server keeps them
const NEAR_PX = 7;

export class Timeline {
  constructor() {
    this.place = $("timeline");
    this.list = $("events");
    this.tip = $("event-tip");
    /** @type {TimelineEvent[]} */
    this.events = [];
    this.time_s = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.due = undefined;
    /** @type {import("../model/timeline.js").Axis} */
    this.x = () => 0; // where a time is
    new ResizeObserver(() => this.redraw(true)).observe(this.place);
    for (const kind of /** @type {const} */ (["pointermove", "pointerdown"]))
      this.place.addEventListener(kind, (event) => this.point(event));
    this.place.addEventListener("pointerleave", (event) => (this.tip.hidden ||= event.pointerType === "mouse"));
    window.addEventListener(
      "pointerdown",
      ({ target }) => (this.tip.hidden ||= !this.place.contains(/** @type {Node} */ (target))),
      true,
    );
    $("legend").replaceChildren(...legend());
  }

  /** @param {{ fresh: boolean, events: TimelineEvent[] }} news */
  add({ fresh, events }) {
    this.events = (fresh ? events : this.events.concat(events)).slice(-MOST);
    this.list.replaceChildren(...this.events.slice(-12).map((event) => make("li", { textContent: words(event) })));
    this.redraw(true);
  }

  /** @param {number} time_s */
  at(time_s) {
    this.time_s = time_s;
    this.redraw(false);
  }

  /** @param {boolean} now */
  redraw(now) {
    if (this.due && !now) return;
    clearTimeout(this.due);
    if (now) this.draw();
    this.due = setTimeout(() => {
      this.due = undefined;
      if (!now) this.draw();
    }, REDRAW_MS);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width) return;
    const end = Math.max(60, this.time_s * 1.03);
    const x = (/** @type {number} */ time_s) => 6 + ((width - 12) * time_s) / end;
    this.x = x;
    const y = height * 0.52;
    this.place.replaceChildren(
      line(x(0), x(end), y, "rest"),
      line(x(0), x(this.time_s), y, "done"),
      ...tickTimes(end, width).map((time) => tick(time ? x(time) : 0, y + 28, time)),
      ...marksOf(this.events, x).map(({ kind, at }) => markAt(kind, at, y)),
      ...labelsOf(this.events, x, width).map(({ kind, at }) => label(at, y - 16, kind)),
      svg("path", { d: `M${x(this.time_s)} ${y - 12}v25`, class: "now" }),
    );
    this.place.setAttribute("aria-label", `Timeline: ${clock(this.time_s)}, ${this.events.length} events`);
  }

  /** Says which events are below the pointer, the newest last. @param {PointerEvent} event */
  point({ clientX }) {
    const { left, width } = this.place.getBoundingClientRect();
    const near = this.events.filter((event) => Math.abs(this.x(event.time_s) - (clientX - left)) <= NEAR_PX);
    this.tip.hidden = near.length === 0;
    const more = near.length > 4 ? [make("p", { textContent: `${near.length - 4} more` })] : [];
    this.tip.replaceChildren(...more, ...near.slice(-4).map((event) => make("p", { textContent: words(event) })));
    const half = this.tip.offsetWidth / 2;
    const inset = left - (this.place.parentElement?.getBoundingClientRect().left ?? 0);
    this.tip.style.left = `${inset + Math.max(half, Math.min(width - half, clientX - left))}px`;
  }
}

/** @param {number} x @param {number} y @param {number} time */
const tick = (x, y, time) =>
  svg("text", { x, y, class: "tick", "text-anchor": time === 0 ? "start" : "middle" }, clock(time));

/** @param {number} x @param {number} y @param {string} kind */
const label = (x, y, kind) =>
  svg("text", { x, y, class: "label", "data-kind": kind, "text-anchor": "middle" }, nameOf(kind));

/** @param {number} from @param {number} to @param {number} y @param {string} kind */
const line = (from, to, y, kind) => svg("path", { d: `M${from} ${y}H${Math.max(from, to)}`, class: kind });

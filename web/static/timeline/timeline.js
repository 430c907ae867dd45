// The timeline: events as marks of different shape and colour, with names where there is room, the moment that is shown, and the
// branches. Dragging it shows the past. Marks that are pointed at or touched say more.

import { $, make, svg, icon, labelled } from "../ui/elements.js";
import { clock, fine } from "../ui/words.js";
import { labelsOf, marksOf, Pointers, tickTimesIn, whole, within, zoomed } from "./line.js";
import { counted, EventList, legend, markAt, nameOf, words } from "./events.js";
import { Comparison, parted } from "./comparison.js";
import { Seeker, Tools } from "./tools.js";

const REDRAW_MS = 500;
const MOST = 2000; // events, as the server keeps them
const NEAR_PX = 7;
const SIDE_PX = 6;
/** @type {Record<string, number>} */
const KEYS_S = { ArrowLeft: -0.1, ArrowRight: 0.1, ArrowDown: -1, ArrowUp: 1, PageDown: -10, PageUp: 10 };

export class Timeline {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.place = $("timeline");
    this.latest = $("events");
    this.tip = $("event-tip");
    /** @type {TimelineEvent[]} */
    this.events = [];
    this.tick = 0;
    this.time_s = 0;
    /** @type {TimeFields | null} */
    this.time = null;
    /** @type {number | null} */
    this.dragged = null; // the time under the pointer, until the page has it
    /** @type {import("./line.js").Span | null} */
    this.part = null; // of the run; null: all of it
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.due = undefined;
    /** @type {import("./line.js").Axis} */
    this.x = () => 0; // where a time is
    this.watches = link.watches;
    this.seeker = new Seeker(link);
    this.list = new EventList(this);
    this.tools = new Tools(this, link);
    this.comparison = new Comparison(this, link);
    this.bookmarks = new Bookmarks(this, link);
    new Pointers(this);
    new ResizeObserver(() => this.redraw(true)).observe(this.place);
    for (const kind of /** @type {const} */ (["pointermove", "pointerdown"]))
      this.place.addEventListener(kind, (event) => this.point(event));
    this.place.addEventListener("keydown", (event) => this.key(event));
    this.place.addEventListener("pointerleave", (event) => (this.tip.hidden ||= event.pointerType === "mouse"));
    window.addEventListener(
      "pointerdown",
      ({ target }) => (this.tip.hidden ||= !this.place.contains(/** @type {Node} */ (target))),
      true,
    );
    $("zoom-in").addEventListener("click", () => this.zoom(0.5, this.shown_s));
    $("zoom-out").addEventListener("click", () => this.zoom(2, this.shown_s));
    $("zoom-all").addEventListener("click", () => this.zoom(Infinity, 0));
    $("legend").replaceChildren(...legend());
  }

  get end_s() {
    return this.time?.end_s ?? this.time_s;
  }

  get shown_s() {
    return this.dragged ?? this.time_s;
  }

  /** Of the longest branch. */
  get all() {
    return whole(Math.max(this.end_s, ...(this.time?.branches ?? []).map(({ end_s }) => end_s)));
  }

  get span() {
    return this.part ?? this.all;
  }

  /** @param {{ fresh: boolean, events: TimelineEvent[] }} news */
  add({ fresh, events }) {
    this.events = counted(fresh ? events : this.events.concat(events)).slice(-MOST);
    this.latest.replaceChildren(...this.events.slice(-12).map((event) => make("li", { textContent: words(event) })));
    this.list.draw();
    this.redraw(true);
  }

  /** @param {{ tick: number, time_s: number }} state @param {TimeFields | null} time */
  at({ tick, time_s }, time) {
    const moved = time?.past && time_s !== this.time_s;
    const jumped = time?.past !== this.time?.past || time?.branches.length !== this.time?.branches.length;
    const looped = JSON.stringify(time?.loop) !== JSON.stringify(this.time?.loop);
    const follows = this.part && !time?.past && this.time_s <= this.part.to;
    [this.tick, this.time_s, this.time] = [tick, time_s, time];
    this.seeker.onMoment();
    if (this.part && follows && time_s > this.part.to) this.pan(0.5);
    if (time) {
      this.tools.show(time, time_s);
      this.comparison.show(time);
      this.bookmarks.show(time);
    }
    this.redraw(Boolean(moved || jumped || looped));
  }

  // ---------------------------------------------------------------- seeking

  /** @param {number} clientX */
  timeAt(clientX) {
    const { left, width } = this.place.getBoundingClientRect();
    const { from, to } = this.span;
    return from + ((to - from) * (clientX - left - SIDE_PX)) / Math.max(1, width - 2 * SIDE_PX);
  }

  /** Shows the moment under the pointer. @param {number} time_s */
  drag(time_s) {
    if (!this.time || this.watches) return;
    this.dragged = Math.min(this.end_s, Math.max(this.time.begin_s, time_s));
    this.seeker.seek({ time_s: this.dragged });
    this.redraw(true);
  }

  letGo() {
    this.dragged = null;
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const by = KEYS_S[event.key];
    if (by !== undefined) this.tools.tick(Math.round(by * 10));
    else if (event.key === "Home") this.seeker.seek({ tick: 0 });
    else if (event.key === "End") this.tools.now();
    else return;
    event.preventDefault();
  }

  // ---------------------------------------------------------------- the span

  /** @param {number} factor @param {number} at */
  zoom(factor, at) {
    this.part = zoomed(this.span, factor, at, this.all);
    this.redraw(true);
  }

  /** Moves the span by a share of its length. @param {number} share */
  pan(share) {
    if (!this.part) return;
    const by = share * (this.part.to - this.part.from);
    this.part = within({ from: this.part.from + by, to: this.part.to + by }, this.all);
    this.redraw(true);
  }

  // ---------------------------------------------------------------- drawing

  /** Now, or soon; and what comes meanwhile, soon afterwards. @param {boolean} now */
  redraw(now) {
    if (now) this.draw();
    this.due ??= setTimeout(() => {
      this.due = undefined;
      this.draw();
    }, REDRAW_MS);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width) return;
    const { from, to } = this.span;
    const x = (/** @type {number} */ time_s) => SIDE_PX + ((width - 2 * SIDE_PX) * (time_s - from)) / (to - from);
    this.x = x;
    const y = height * 0.5;
    const inside = (/** @type {number} */ time_s) => Math.min(width, Math.max(0, x(time_s)));
    const events = this.list.shown.filter(({ time_s }) => time_s >= from && time_s <= to);
    this.place.replaceChildren(
      ...this.branchLines(y, inside),
      line(inside(from), inside(to), y, "rest"),
      line(inside(0), inside(this.end_s), y, this.time?.past ? "ahead" : "done"),
      line(inside(0), inside(this.shown_s), y, "done"),
      ...this.loopMarks(y, inside),
      ...tickTimesIn(from, to, width).map((time) => tick(time ? x(time) : 0, height - 4, time)),
      ...this.bookmarks.marks(x, y, from, to),
      ...marksOf(events, x).map(({ kind, at }) => markAt(kind, at, y)),
      ...labelsOf(events, x, width).map(({ kind, at }) => label(at, y - 13, kind)),
      svg("path", { d: `M${x(this.shown_s)} ${y - 12}v24`, class: "now" }),
      svg("circle", { cx: x(this.shown_s), cy: y + 13, r: this.time?.past ? 5 : 0, class: "grip" }),
    );
    this.describe();
  }

  /** The state of the slider for screen readers. */
  describe() {
    const says = `${fine(this.shown_s)} of ${clock(this.end_s)}${this.time?.past ? ", the past" : ""}, ${this.events.length} events`;
    const values = { valuemin: this.time?.begin_s ?? 0, valuemax: this.end_s, valuenow: this.shown_s };
    for (const [name, value] of Object.entries(values)) this.place.setAttribute(`aria-${name}`, value.toFixed(1));
    this.place.setAttribute("aria-valuetext", says);
  }

  /** The other branches, each a line that leaves its parent's. @param {number} y @param {import("./line.js").Axis} x */
  branchLines(y, x) {
    const { branches = [], branch = 1 } = this.time ?? {};
    return branches
      .filter(({ number }) => number !== branch)
      .slice(-3)
      .map(({ number, end_s }, row) => {
        const [a, b, down] = [x(parted(branches, branch, number)), x(end_s), y + 6 + 5 * row];
        return svg(
          "path",
          { d: `M${a} ${y}L${Math.min(b, a + 5)} ${down}H${b}`, class: "branch" },
          svg("title", {}, `Branch ${number}`),
        );
      });
  }

  /** @param {number} y @param {import("./line.js").Axis} x */
  loopMarks(y, x) {
    const { a } = this.tools;
    const loop = this.time?.loop ?? (a === null ? null : [a, a]);
    if (!loop) return [];
    const [from, to] = loop.map(x);
    return [
      svg("path", { d: `M${from + 3} ${y - 9}h-3v18h3M${to - 3} ${y - 9}h3v18h-3M${from} ${y}H${to}`, class: "loop" }),
    ];
  }

  /** The events below a pointer, the newest last. @param {number} clientX */
  near(clientX) {
    const { left } = this.place.getBoundingClientRect();
    return this.list.shown.filter((event) => Math.abs(this.x(event.time_s) - (clientX - left)) <= NEAR_PX);
  }

  /** Says which events are below the pointer. @param {PointerEvent} event */
  point({ clientX }) {
    const { left, width } = this.place.getBoundingClientRect();
    const near = this.near(clientX);
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

export class Bookmarks {
  /** @param {Timeline} timeline @param {import("../net/connection.js").Connection} link */
  constructor(timeline, link) {
    this.timeline = timeline;
    this.link = link;
    this.drawn = "";
    /** @type {Bookmark[]} */
    this.rows = [];
    /** @type {number | null} */
    this.naming = null; // the tick of the bookmark whose name is being written
    /** @type {() => unknown} */
    this.share = () => {}; // makes a link of the moment that is shown
    $("bookmark").addEventListener("click", () => this.put());
  }

  /** Names the moment that is shown by its time; the name can be written at once. */
  async put() {
    const tick = this.timeline.tick;
    if (!this.timeline.list.open) this.timeline.list.toggle();
    if (this.rows.some((row) => row.tick === tick)) return this.name(tick);
    const answer = await this.link.ask({ type: "put_bookmark", name: fine(this.timeline.time_s) });
    if (answer.accepted) this.naming = answer.tick ?? tick;
    this.draw();
  }

  /** @param {TimeFields} time */
  show({ bookmarks }) {
    const drawn = JSON.stringify(bookmarks);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    this.rows = bookmarks;
    this.draw();
    this.timeline.redraw(true);
  }

  draw() {
    $("bookmarks").hidden = this.rows.length === 0;
    $("bookmark-list").replaceChildren(...this.rows.map((row) => this.row(row)));
    const field = $("bookmark-list").querySelector("input");
    field?.focus();
    field?.select();
  }

  /** @param {number | null} tick */
  name(tick) {
    this.naming = tick;
    this.draw();
  }

  /** @param {Bookmark} bookmark */
  row({ tick, time_s, name }) {
    if (tick === this.naming) return make("li", {}, this.form(tick, name));
    const go = make("button", { type: "button", className: "go-there" });
    go.append(make("time", { textContent: fine(time_s) }), make("span", { textContent: name }));
    go.addEventListener("click", () => this.timeline.seeker.seek({ tick }));
    return make(
      "li",
      {},
      go,
      this.button("edit", `Another name for ${name}`, () => this.name(tick)),
      this.button("share", `Link to ${name}`, async () => {
        await this.timeline.seeker.seek({ tick });
        this.share();
      }),
      this.button("delete", `Delete ${name}`, () => this.link.ask({ type: "remove_bookmark", tick })),
    );
  }

  /** @param {string} picture @param {string} words @param {() => unknown} action */
  button(picture, words, action) {
    const button = labelled(words, make("button", { type: "button", className: "tiny" }, icon(picture)));
    button.addEventListener("click", action);
    return button;
  }

  /** @param {number} tick @param {string} name */
  form(tick, name) {
    const field = labelled(
      "Name of the bookmark",
      make("input", { type: "text", value: name, maxLength: 60, required: true, autocomplete: "off" }),
    );
    const form = make("form", {}, field, make("button", { type: "submit", className: "tiny", textContent: "Name it" }));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const wish = field.value.trim();
      this.naming = null;
      if (wish && wish !== name) await this.link.ask({ type: "put_bookmark", name: wish, tick });
      this.draw();
    });
    field.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.name(null);
      $("bookmark").focus();
    });
    return form;
  }

  /** @param {import("./line.js").Axis} x @param {number} y @param {number} from @param {number} to */
  marks(x, y, from, to) {
    return this.rows
      .filter(({ time_s }) => time_s >= from && time_s <= to)
      .map(({ time_s, name }) =>
        svg(
          "path",
          { d: `M${x(time_s) - 3.5} ${y + 4}h7v9l-3.5-3-3.5 3z`, class: "bookmark" },
          svg("title", {}, `${fine(time_s)} ${name}`),
        ),
      );
  }
}

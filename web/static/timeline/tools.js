// The buttons above the timeline: steps, events, marks of a loop, branches, going on from the past and back to now. And who asks for
// moments of the past.

import { $, find, icon, labelled, make } from "../ui/elements.js";
import { clock, fine } from "../ui/words.js";

export class Tools {
  /** @param {import("./timeline.js").Timeline} timeline @param {import("../net/connection.js").Connection} link */
  constructor(timeline, link) {
    this.timeline = timeline;
    this.link = link;
    /** @type {number | null} */
    this.a = null; // where a loop is to begin, until it has an end
    this.told = "";
    const steps = /** @type {const} */ ({ "second-back": -10, "tick-back": -1, "tick-on": 1, "second-on": 10 });
    for (const [id, ticks] of Object.entries(steps))
      $(/** @type {keyof typeof steps} */ (id)).addEventListener("click", () => this.tick(ticks));
    $("event-back").addEventListener("click", () => this.event(-1));
    $("event-on").addEventListener("click", () => this.event(1));
    $("now").addEventListener("click", () => this.now());
    $("go-on").addEventListener("click", () => link.ask({ type: "go_on_from_here" }));
    $("mark-a").addEventListener("click", () => this.mark(timeline.time_s, this.b));
    $("mark-b").addEventListener("click", () => this.mark(this.a ?? timeline.time?.loop?.[0] ?? null, timeline.time_s));
    $("loop-off").addEventListener("click", () => this.mark(null, null));
  }

  get b() {
    return this.timeline.time?.loop?.[1] ?? null;
  }

  /** Goes on or back by ticks. Beyond the present, it is made. @param {number} ticks */
  tick(ticks) {
    const { time, seeker } = this.timeline;
    if (!time) return;
    const tick = seeker.aim ?? this.timeline.tick;
    if (ticks > 0 && !time.past && seeker.aim === null) this.link.ask({ type: "step", ticks });
    else seeker.seek({ tick: Math.min(time.end_tick, Math.max(0, tick + ticks)) });
  }

  /** @param {1 | -1} way */
  event(way) {
    const { list, time_s, time } = this.timeline;
    const at = nextEvent(list.shown, time_s, way);
    if (at !== undefined) this.timeline.seeker.seek({ time_s: at });
    else if (way > 0 && time?.past) this.now();
  }

  now() {
    if (this.timeline.time?.past) this.link.ask({ type: "back_to_now" });
  }

  /** @param {number | null} a @param {number | null} b */
  mark(a, b) {
    const whole = a !== null && b !== null && b - a >= 0.1;
    this.a = whole ? null : a;
    if (whole) this.link.ask({ type: "loop", begin_s: a, end_s: b });
    else if (this.timeline.time?.loop) this.link.ask({ type: "loop" });
    this.timeline.redraw(true);
  }

  /** @param {TimeFields} time @param {number} time_s */
  show(time, time_s) {
    document.body.dataset.past = String(time.past);
    for (const id of /** @type {const} */ (["past", "go-on", "now"])) $(id).hidden = !time.past;
    find($("past"), "b").textContent = fine(time_s);
    $("past").title = `${fine(time_s)} of ${clock(time.end_s)}`;
    const done = /** @type {HTMLProgressElement} */ ($("time-done"));
    done.hidden = !time.doing;
    done.value = time.done;
    done.setAttribute("aria-label", time.doing || "nothing");
    $("loop-off").hidden = !time.loop && this.a === null;
    const told = JSON.stringify([time.branch, time.branches.length, time.sides.length]);
    if (told !== this.told) this.branches(time);
    this.told = told;
  }

  /** @param {TimeFields} time */
  branches({ branch, branches, sides }) {
    const place = $("branches");
    place.hidden = branches.length < 2;
    place.replaceChildren(
      ...branches.map(({ number, parent, from_s }) => {
        const words =
          parent === null
            ? "Branch 1, the run as it began"
            : `Branch ${number}, from ${clock(from_s)} of branch ${parent}`;
        const button = labelled(
          words,
          make("button", { type: "button", className: "tiny", textContent: String(number) }),
        );
        button.setAttribute("aria-pressed", String(number === branch));
        button.addEventListener("click", () => this.link.ask({ type: "change_branch", number }));
        return button;
      }),
      this.besideButton(sides.length > 0),
    );
  }

  /** @param {boolean} on */
  besideButton(on) {
    const button = labelled(
      "Branches side by side",
      make("button", { type: "button", className: "tiny" }, icon("sides")),
    );
    button.setAttribute("aria-pressed", String(on));
    button.addEventListener("click", () => this.timeline.comparison.toggle());
    return button;
  }
}

/**
 * The time of the next event after a time (`way` 1) or before it (-1); undefined: there is none.
 * @param {TimelineEvent[]} events oldest first
 * @param {number} time_s
 * @param {1 | -1} way
 */
export function nextEvent(events, time_s, way) {
  const times = events.map((event) => event.time_s).filter((time) => (time - time_s) * way > 0.05);
  return way > 0 ? times[0] : times.at(-1);
}

const PATIENCE_MS = 150;

const RESTED_MS = 25;

const LOOK_MS = 10;

/**
 * Asks for moments one at a time: while one is on its way, only the newest wish waits. A moment that takes long is given up for a
 * newer wish; where the pointer has come to rest, at once, but not twice running: a slow drag rests at each step.
 */
export class Seeker {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.link = link;
    /** @type {Seek | null} */
    this.wish = null;
    this.wished = 0; // when, ms
    this.busy = false;
    this.gaveUp = false; // the last moment, before it came
    /** @type {number | null} */
    this.aim = null; // the tick asked for last, until the page is told of it: quick steps count from here
  }

  /** The page has been told of a moment. What comes after an answer is not older than it. */
  told() {
    if (!this.busy) this.aim = null;
  }

  /** @param {Omit<Seek, "type">} where */
  async seek(where) {
    this.wish = { type: "seek", ...where };
    this.wished = performance.now();
    this.aim = where.tick ?? null;
    if (this.busy) return;
    this.busy = true;
    while (this.wish) {
      const wish = this.wish;
      this.wish = null;
      await this.answered(wish);
    }
    this.busy = false;
  }

  /** Waits for the answer, or until a newer wish has waited for long enough. @param {Seek} wish */
  async answered(wish) {
    let here = false;
    const answer = this.link.ask(wish).then(() => {
      here = true;
    });
    const asked = performance.now();
    const isOver = () =>
      performance.now() - asked > PATIENCE_MS || (!this.gaveUp && performance.now() - this.wished > RESTED_MS);
    while (!here && !(this.wish && isOver()))
      await Promise.race([answer, new Promise((resolve) => setTimeout(resolve, LOOK_MS))]);
    this.gaveUp = !here;
  }
}

// What steers time: the buttons above the timeline (steps, events, marks of a loop, branches, going on from the past and back to now),
// who asks for moments of the past, and what to run until.

import { $, find, icon, labelled, make, renew, say } from "../ui/elements.js";
import { clock, fine, toast } from "../ui/words.js";

export class Tools {
  /** @param {import("./timeline.js").Timeline} timeline @param {import("../net/connection.js").Connection} link */
  constructor(timeline, link) {
    this.timeline = timeline;
    this.link = link;
    /** @type {number | null} */
    this.a = null; // where a loop is to begin, until it has an end
    this.drawn = "";
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
    const drawn = JSON.stringify([time.branch, time.branches.length, time.sides.length]);
    if (drawn !== this.drawn) this.branches(time);
    this.drawn = drawn;
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
    this.aim = null; // the tick asked for last, until it arrives: quick steps count from here
  }

  /** A moment has arrived. What comes after an answer is not older than it. */
  onMoment() {
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

/** @type {{ words: string, wish: Omit<RunUntil, "type"> }[]} */
export const CHOICES = [
  { words: "a loop closes", wish: { what: "closure" } },
  { words: "it is lost", wish: { what: "lost" } },
  { words: "it has recovered", wish: { what: "found again" } },
  { words: "the packet snaps", wish: { what: "snap" } },
  { words: "it is at its goal", wish: { what: "goal reached" } },
  { words: "everything is explored", wish: { what: "explored", within_s: 36000 } },
];

/** So many packets can be waited for. */
const PACKETS = { least: 2, most: 9 };

/** What is said when it has happened; null while it runs, and if it was broken off. A warning says that it came too late. @param {UntilView} until */
export const ending = ({ state, words }) => (state === "met" ? `Stopped at this very tick: ${words}.` : null);

/** @typedef {Omit<RunUntil, "type">} Wish */

/** "Until": runs as fast as it can until something happens, and stops at that very tick. */
export class RunUntilMenu {
  /**
   * @param {(wish: Command) => Promise<boolean>} command
   * @param {() => boolean} shownElsewhere whether somebody else shows that it runs, and says what comes of it
   */
  constructor(command, shownElsewhere) {
    this.shownElsewhere = shownElsewhere;
    /** @type {UntilView["state"] | null} */
    this.state = null;
    this.command = command;
    const { least, most } = PACKETS;
    this.count = make("input", { type: "number", value: String(least), min: String(least), max: String(most) });
    this.count.setAttribute("aria-label", "How many packets");
    this.place = make("select", { ariaLabel: "Which place" });
    this.comes = this.row("it comes to", this.place, () => ({ what: "place", place: this.place.value }));
    const packets = this.row("packets compete:", this.count, () => ({
      what: "packets",
      count: this.count.valueAsNumber,
    }));
    $("until-list").replaceChildren(
      ...CHOICES.map(({ words, wish }) => this.button(words, () => wish)),
      packets,
      this.comes,
    );
    $("until-open").addEventListener("click", () => this.show($("until-box").hidden === true));
    $("until-cancel").addEventListener("click", () => command({ type: "pause" }));
    window.addEventListener("pointerdown", ({ target }) => {
      const inside = [$("until-box"), $("until-open")].some((part) => part.contains(/** @type {Node} */ (target)));
      if (!inside) this.show(false);
    });
  }

  /** @param {string} words @param {() => Wish} wish */
  button(words, wish) {
    const button = make("button", { type: "button", textContent: words });
    button.addEventListener("click", async () => {
      this.show(false);
      $("until-open").focus();
      await this.command({ type: "run_until", ...wish() });
    });
    return button;
  }

  /** A choice with something to fill in. @param {string} words @param {HTMLElement} field @param {() => Wish} wish */
  row(words, field, wish) {
    return make("div", { className: "until-row" }, this.button(words, wish), field);
  }

  /** @param {State} state @param {PageFields["places"]} places of the office, by name */
  at({ until }, places) {
    const names = places.map(([name]) => name);
    this.comes.hidden = !names.length;
    renew(this.place, names, () => names.map((name) => make("option", { value: name, textContent: name })));
    const before = this.state;
    this.state = until?.state ?? null;
    $("until").hidden = until?.state !== "running" || this.shownElsewhere();
    if (!until) return;
    say($("until-words"), until.words);
    $("until-done").value = until.progress;
    const end = before === "running" ? ending(until) : null;
    if (end && !this.shownElsewhere()) toast(end, { notice: true });
  }

  /** @param {boolean} on */
  show(on) {
    $("until-box").hidden = !on;
    $("until-open").setAttribute("aria-expanded", String(on));
  }

  /** True when it was open. */
  close() {
    if ($("until-box").hidden) return false;
    this.show(false);
    $("until-open").focus();
    return true;
  }
}

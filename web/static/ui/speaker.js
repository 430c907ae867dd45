// What is read aloud to who cannot see the stage: events that matter, not too many at once. It comes into the page's live region,
// in breaths of some seconds.

import { nameOf, weightOf } from "../timeline/events.js";
import { ended } from "./words.js";
import { $ } from "./elements.js";

const TOLD = new Set(
  /** @type {EventKind[]} */ ([
    "kidnap",
    "lost",
    "believes",
    "joined",
    "corrected",
    "recovered",
    "goal",
    "arrived",
    "unreachable",
    "closure",
    "fault",
    "trial",
    "reached",
    "failed",
    "tagged",
    "branch",
    "recording",
    "snap",
    "lesson",
  ]),
); // not "warning": its toast is in a live region of its own
/** Kinds that come in swarms: not again within so many seconds. @type {Record<string, number>} */
const SELDOM_S = { snap: 15, closure: 6 };
const MOST = 3; // events in one breath

export class Speech {
  /** @type {Pick<TimelineEvent, "kind" | "text">[]} */
  #waiting = [];

  /** When each kind was last taken in, s. @type {Map<string, number>} */
  #heard_s = new Map();

  /** @param {Pick<TimelineEvent, "kind" | "text">[]} events @param {number} now_s of the wall clock */
  hear(events, now_s) {
    for (const event of events) {
      const { kind } = event;
      const silent_s = now_s - (this.#heard_s.get(kind) ?? -Infinity);
      if (!TOLD.has(/** @type {EventKind} */ (kind)) || silent_s < (SELDOM_S[kind] ?? 0)) continue;
      this.#heard_s.set(kind, now_s);
      this.#waiting.push(event);
    }
  }

  /** The next words, "" when there is nothing to say. Of too many, those of the greatest weight are said, in their order. */
  next() {
    const weights = this.#waiting.map(({ kind }) => weightOf(kind)).sort((a, b) => b - a);
    const least = weights[MOST - 1] ?? -Infinity;
    const said = this.#waiting.filter(({ kind }) => weightOf(kind) >= least).slice(-MOST);
    const left = this.#waiting.length - said.length;
    this.#waiting = [];
    const words = said.map(({ kind, text }) =>
      ended(text.startsWith(nameOf(kind)) ? text : `${nameOf(kind)}: ${text}`),
    );
    return words.join(" ") + (left > 0 ? ` And ${left} more ${left === 1 ? "event" : "events"}.` : "");
  }
}

const BREATH_MS = 3000;

export class Speaker {
  constructor() {
    this.speech = new Speech();
    this.silent = true; // until something waits
  }

  /** Events that have just happened. @param {TimelineEvent[]} events */
  hear(events) {
    this.speech.hear(events, performance.now() / 1000);
    if (this.silent) this.speak();
  }

  speak() {
    const words = this.speech.next();
    this.silent = words === "";
    if (this.silent) return;
    $("said").textContent = words;
    setTimeout(() => this.speak(), BREATH_MS);
  }
}

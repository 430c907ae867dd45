// For who does not see the plates: what happens is read aloud, and the places that the robot knows are a list.

import { nameOf, weightOf } from "../timeline/events.js";
import { ended } from "./words.js";
import { $, make, renew } from "./elements.js";
import { get } from "../net/post.js";

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
const MOST_EVENTS = 3; // events in one breath

/** What is read aloud: events that matter, not too many at once. */
export class Speech {
  /** @type {Pick<TimelineEvent, "kind" | "text">[]} */
  #waiting = [];

  /** When each kind was last taken in, s. @type {Map<string, number>} */
  #heard_s = new Map();

  /** @param {Pick<TimelineEvent, "kind" | "text">[]} events @param {number} now_s of the wall clock */
  onEvents(events, now_s) {
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
    const least = weights[MOST_EVENTS - 1] ?? -Infinity;
    const said = this.#waiting.filter(({ kind }) => weightOf(kind) >= least).slice(-MOST_EVENTS);
    const left = this.#waiting.length - said.length;
    this.#waiting = [];
    const words = said.map(({ kind, text }) =>
      ended(text.startsWith(nameOf(kind)) ? text : `${nameOf(kind)}: ${text}`),
    );
    return words.join(" ") + (left > 0 ? ` And ${left} more ${left === 1 ? "event" : "events"}.` : "");
  }
}

const BREATH_MS = 3000;

/** Puts it into the page's live region, in breaths of some seconds. */
export class Speaker {
  constructor() {
    this.speech = new Speech();
    this.silent = true; // until something waits
  }

  /** Events that have just happened. @param {TimelineEvent[]} events */
  onEvents(events) {
    this.speech.onEvents(events, performance.now() / 1000);
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

/**
 * Map frame, metres. `seconds`: the quickest way; null: none is known.
 * @typedef {{ name: string, experience: number, x: number, y: number }} TagPlace
 * @typedef {{ id: number, x: number, y: number, seconds: number | null }} ExperiencePlace
 * `why`: why the map knows no way to a place of the office; null: it does.
 * @typedef {{ name: string, experience: number | null, x: number | null, y: number | null, why: string | null }} NamedPlace
 * @typedef {{ robot: Pose, to_goal: boolean, tags: TagPlace[], named: NamedPlace[], experiences: ExperiencePlace[] }} Places
 * @typedef {{ tag: string | null, experience: number, x: number, y: number, title: string, where: string, why?: string | null }} Choice
 */

const SIDES = ["ahead", "ahead to the left", "to the left", "behind to the left", "behind", "behind to the right"];
SIDES.push("to the right", "ahead to the right");

/** Where a place is for the robot, in words. @param {Pose} robot @param {{ x: number, y: number }} place */
export function whereabouts(robot, { x, y }) {
  const far = Math.hypot(x - robot.x, y - robot.y);
  if (far < 0.3) return "here";
  const turn = Math.atan2(y - robot.y, x - robot.x) - robot.heading_rad;
  const eighth = ((Math.round((turn / (2 * Math.PI)) * 8) % 8) + 8) % 8;
  return `${far.toFixed(far < 10 ? 1 : 0)} m ${SIDES[eighth]}`;
}

const APART_M = 1; // without a word to seek, experiences so far from one another and from the robot stand for the rest

/**
 * The places whose words hold what was typed: those with a name first, then those of the office, then experiences, the nearest first. While nothing is
 * typed, a few experiences stand for all.
 * @param {Places} places
 * @param {string} typed
 * @param {number} most
 * @returns {Choice[]}
 */
export function choices({ robot, to_goal, tags, named: office, experiences }, typed, most) {
  const far = (/** @type {{ x: number, y: number }} */ { x, y }) => Math.hypot(x - robot.x, y - robot.y);
  const named = tags.map((tag) => ({ ...tag, tag: tag.name, title: tag.name, where: whereabouts(robot, tag) }));
  const places = office.map(({ name, experience, x, y, why }) => ({
    ...{ tag: null, experience: experience ?? -1, x: x ?? 0, y: y ?? 0, title: name, why },
    where: x === null || y === null ? (why ?? "") : whereabouts(robot, { x, y }),
  }));
  const known = places.filter(({ why }) => why === null);
  const unknown = places.filter(({ why }) => why !== null);
  const sought = typed.trim().toLowerCase();
  const near = experiences.toSorted((a, b) => far(a) - far(b));
  const others = (sought ? near : spread(near, [robot])).map(({ id, x, y, seconds }) => {
    const way = to_goal ? "" : seconds === null ? ", no route known" : `, ${Math.round(seconds)} s`;
    return { tag: null, experience: id, x, y, title: `Experience ${id}`, where: whereabouts(robot, { x, y }) + way };
  });
  return [...named, ...known, ...unknown, ...others]
    .filter(({ title }) => title.toLowerCase().includes(sought))
    .slice(0, most);
}

/** @param {ExperiencePlace[]} places @param {{ x: number, y: number }[]} from */
function spread(places, from) {
  /** @type {ExperiencePlace[]} */
  const kept = [];
  for (const place of places)
    if ([...from, ...kept].every(({ x, y }) => Math.hypot(x - place.x, y - place.y) >= APART_M)) kept.push(place);
  return kept;
}

const MOST_ROWS = 60; // rows

/** The places of the map and of the office: type, choose, go there or look at it; what the map does not know is looked for. */
export class PlaceList {
  /**
   * @param {(wish: Command, done?: string) => Promise<boolean>} command
   * @param {() => void} inspected called when a place is to be looked at
   */
  constructor(command, inspected) {
    this.command = command;
    this.inspected = inspected;
    this.dialog = $("places-dialog");
    /** @type {Places | null} */
    this.places = null;
    $("places-close").addEventListener("click", () => this.dialog.close());
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
    $("places-typed").addEventListener("input", () => this.draw());
    $("places-form").addEventListener("submit", (event) => {
      event.preventDefault();
      const first = this.found.find(({ why }) => !why) ?? this.found[0];
      if (first) this.go(first);
    });
  }

  /** @param {boolean} byKey */
  async open(byKey) {
    this.places = null;
    $("places-typed").value = "";
    $("places-said").textContent = "Asking the robot";
    this.dialog.showModal();
    if (byKey || !window.matchMedia("(pointer: coarse)").matches) $("places-typed").focus(); // a keyboard on the screen would cover the list
    const { data, wrong } = await get("/api/places");
    this.places = data;
    if (wrong) $("places-said").textContent = wrong;
    this.draw();
  }

  get found() {
    return this.places ? choices(this.places, $("places-typed").value, MOST_ROWS) : [];
  }

  draw() {
    const { found } = this;
    renew(
      $("places-list"),
      found.map((choice) => `${choice.title} ${choice.where}`),
      () => found.map((choice) => this.row(choice)),
    );
    if (!this.places) return;
    const { tags, named, experiences } = this.places;
    const all = tags.length + named.length + experiences.length;
    $("places-said").textContent =
      found.length < all ? `${found.length} of ${all} places. A number finds the others.` : `${all} places`;
  }

  /** @param {Choice} choice */
  row(choice) {
    const go = make(
      "button",
      { type: "button", className: "go-there" },
      make("b", { textContent: choice.title }),
      ` ${choice.where}`,
    );
    go.addEventListener("click", () => this.go(choice));
    go.setAttribute("aria-label", `Go to ${choice.title}, ${choice.where}`);
    if (choice.why) return make("li", {}, go);
    const look = make("button", { type: "button", textContent: "Inspect" });
    look.setAttribute("aria-label", `Inspect ${choice.title}`);
    look.addEventListener("click", () => this.look(choice));
    return make("li", {}, go, look);
  }

  /** There by the map; to a place that the map does not know by exploring until the robot comes there. @param {Choice} choice */
  async go({ tag, x, y, title, why }) {
    this.dialog.close();
    if (why) {
      if (await this.command({ type: "set_mode", mode: "explore" }))
        await this.command({ type: "run_until", what: "place", place: title });
      return;
    }
    await this.command(
      tag === null ? { type: "set_goal", x, y } : { type: "go_to_tag", name: tag },
      `On the way to ${title}.`,
    );
  }

  /** @param {Choice} choice */
  async look({ experience }) {
    this.dialog.close();
    if (await this.command({ type: "inspect", experience })) this.inspected();
  }
}

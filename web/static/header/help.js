// The help: the three plates as they are now, and every key by group, written from the table by which the page acts. And the first
// visit: what this is, and three things to do, ticked off as they happen. Put away, it stays away; the help brings it back.

import { $, find, keep, kept, make, setIcon } from "../ui/elements.js";
import { DRIVING, GROUPS, written } from "../ui/keys.js";
import { sentence } from "../ui/words.js";

const ARROWS = ["↑", "←", "↓", "→"];

export class Help {
  constructor() {
    this.dialog = $("help-dialog");
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.toggle());
    $("help-close").addEventListener("click", () => this.toggle());
    this.write(["w", "a", "s", "d"]);
    this.writeLayout();
  }

  /** With what this keyboard writes on the keys that drive, where the browser tells. */
  async writeLayout() {
    const { keyboard } = /** @type {{ keyboard?: { getLayoutMap(): Promise<Map<string, string>> } }} */ (navigator);
    const layout = await keyboard?.getLayoutMap().catch(() => undefined); // not in a frame, or not allowed
    if (layout?.size) this.write(DRIVING.map((code) => layout.get(code) ?? code[3].toLowerCase()));
  }

  /** @param {string[]} driving what is written on the four keys that drive */
  write(driving) {
    $("keys").replaceChildren(...GROUPS.map((group) => groupOf(group, driving)));
    $("drive-keys").textContent = driving.join("").toUpperCase();
  }

  toggle() {
    if (this.dialog.open) this.dialog.close();
    else this.show();
  }

  show() {
    const theme = document.documentElement.dataset.theme ?? "dark";
    for (const picture of this.dialog.querySelectorAll("img")) {
      picture.onload = () => (picture.hidden = false);
      picture.onerror = () => (picture.hidden = true); // before the first tick there is none, nor is there an office in a recording
      picture.src = `/api/picture/${picture.dataset.plate}?theme=${theme}`;
    }
    this.dialog.showModal();
  }
}

/** @param {import("../ui/keys.js").Group} group @param {string[]} driving */
function groupOf({ title, rows }, driving) {
  const drive = { keys: [...ARROWS, ...driving], words: "drive while held" };
  const all = title === "Robot" ? [drive, ...rows] : rows;
  return make(
    "section",
    {},
    make("h4", { textContent: title }),
    make(
      "ul",
      {},
      ...all.map(({ keys, words }) =>
        make(
          "li",
          {},
          ...keys.map((key) =>
            make("kbd", { textContent: (words !== drive.words && driving.includes(key) ? "⇧" : "") + written(key) }),
          ),
          ` ${words}`,
        ),
      ),
    ),
  );
}

const KEY = "first minute";
const STRIDE = 300; // ticks between two looks at how far it is

/** The first visit, as a card. */
export class FirstMinuteCard {
  /** @param {import("../net/connection.js").Connection} link @param {(event: number) => void} why shows why it happened */
  constructor(link, why) {
    this.link = link;
    this.box = $("first");
    this.things = new FirstMinute();
    this.tick = 0;
    this.run = -1;
    this.hurries = false;
    this.hastens = false; // runs quickly until it is found again
    /** @type {UntilView["state"] | null} */
    this.until = null;
    /** @type {(() => void)[]} */
    this.later = [];
    $("first-explore").addEventListener("click", () => this.hurry());
    $("first-find").addEventListener("click", () => this.find());
    $("first-why").addEventListener("click", () => this.things.why !== null && why(this.things.why));
    $("first-close").addEventListener("click", () => this.show(false));
    $("help-first").addEventListener("click", () => {
      $("help-dialog").close();
      this.things = new FirstMinute();
      this.show(true);
    });
    this.show(kept(KEY) === null);
  }

  /** @param {boolean} on */
  show(on) {
    this.box.hidden = !on;
    document.body.dataset.first = String(on);
    if (!on) {
      keep(KEY, "seen");
      for (const say of this.later.splice(0)) say();
    }
    this.draw();
  }

  /** Whether it tells to watch the robot find itself. No way to any goal is known meanwhile, which need not be said. */
  get searches() {
    return this.things.searches && this.box.checkVisibility();
  }

  /** Whether it shows that this runs quickly, so that nobody else need show it, nor say what comes of it. */
  get finds() {
    return this.hastens && this.box.checkVisibility();
  }

  /** Says what can wait until the card is put away: a newcomer has enough to read. @param {() => void} say */
  afterwards(say) {
    if (this.box.hidden) say();
    else this.later.push(say);
  }

  /** @param {State} state @param {PageFields} page */
  at({ tick, trial, lesson, until }, { recording, time, run }) {
    this.tick = tick;
    const aside = Boolean(trial || lesson || recording || time?.past);
    if (!aside && run !== this.run) [this.run, this.things] = [run, new FirstMinute()]; // what was done with another robot
    const ended = until?.state !== "running" && (this.until === "running" || this.things.found);
    if (this.hastens && ended) {
      if (this.finds && until?.state === "met") this.link.ask({ type: "resume" });
      this.hastens = false;
    }
    this.until = until?.state ?? null;
    if (this.box.hidden) return;
    $("first-search").value = until?.progress ?? 0;
    this.things.at(tick);
    this.box.classList.toggle("aside", aside);
    this.draw();
  }

  /** Events that have just happened. @param {TimelineEvent[]} events */
  onEvents(events) {
    this.things.onEvents(events);
    this.draw();
  }

  draw() {
    const { explored, reached, found, done } = this.things;
    const now = [explored, reached, found].indexOf(false);
    for (const [k, is] of [explored, reached, found].entries()) {
      const row = this.box.querySelectorAll("li")[k];
      row.dataset.state = is ? "done" : k === now ? "now" : "later";
      setIcon(find(row, ".tick"), is ? "check" : "next");
      find(row, ".gone").textContent = is ? "done: " : "";
    }
    $("first-explore").hidden = explored;
    $("first-find").hidden = !this.things.searches || this.hastens;
    $("first-search").hidden = !this.hastens;
    $("first-share").hidden = !this.hurries;
    $("first-share").value = this.tick / FirstMinute.TICKS;
    $("first-end").hidden = !done;
    $("first-after").textContent = this.things.after ? sentence(this.things.after) : "The ? at the top tells the rest.";
    $("first-why").hidden = this.things.why === null;
  }

  /** Let it run as fast as the machine can until it is found again, and play on. */
  async find() {
    this.hastens = true;
    this.draw();
    if (!(await this.link.ask({ type: "run_until", what: "found again" })).accepted) this.hastens = false;
    this.draw();
  }

  /** Let it explore as fast as the machine can, and play on. */
  async hurry() {
    if (this.hurries) return;
    this.hurries = true;
    while (!this.things.explored && !this.box.hidden) {
      const ticks = Math.min(STRIDE, FirstMinute.TICKS - this.tick);
      if (ticks < 1 || !(await this.link.ask({ type: "step", ticks })).accepted) break;
      this.things.at(this.tick + ticks);
      this.tick += ticks;
      this.draw();
    }
    this.hurries = false;
    await this.link.ask({ type: "resume" });
    this.draw();
  }
}

/** The three things that a newcomer does, and when each is done. */
export class FirstMinute {
  explored = false;
  reached = false;
  found = false;
  #moved = false; // kidnapped, and not found again
  after = ""; // how long that took
  /** @type {number | null} the event in which it believed its place again */
  why = null;

  /** Ticks of exploring before the robot knows enough to be sent somewhere: three minutes. */
  static TICKS = 1800;

  /** @param {number} tick */
  at(tick) {
    this.explored ||= tick >= FirstMinute.TICKS;
  }

  /** @param {Pick<TimelineEvent, "kind" | "text" | "number">[]} events those that have just happened */
  onEvents(events) {
    for (const { kind, text, number } of events) {
      if (kind === "arrived") this.reached = true;
      else if (kind === "kidnap") this.#moved = true;
      else if (kind === "believes" && this.#moved) this.why = number;
      else if (kind === "recovered" && this.#moved) {
        this.found = true;
        this.after = text;
      }
    }
  }

  /** Whether it is on its way back to where it knows its place. */
  get searches() {
    return this.#moved && !this.found;
  }

  get done() {
    return this.explored && this.reached && this.found;
  }
}

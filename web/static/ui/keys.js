// Every key of the page, once: what it means where it is pressed. The page acts by this table, and the help is written from it.
// Keys are handled before viser sees them, in the page and in the viewer's frame.

import { within } from "./elements.js";

/**
 * `keys`: as the browser calls them, lower case. `act`: what they do; main.js has a function for each. `words`: for people.
 * @typedef {{ keys: readonly string[], act: string, words: string }} Row
 * @typedef {{ title: string, rows: readonly Row[] }} Group
 */

export const GROUPS = /** @type {const} */ ([
  {
    title: "Robot",
    rows: [
      { keys: ["e"], act: "explore", words: "explore by itself" },
      { keys: ["k"], act: "kidnap", words: "kidnap: somewhere else, untold" },
      { keys: ["/"], act: "places", words: "choose a place to go to from a list" },
      { keys: ["x"], act: "cancel", words: "cancel the goal" },
    ],
  },
  {
    title: "Time",
    rows: [
      { keys: [" "], act: "play", words: "play or pause" },
      { keys: ["."], act: "tick", words: "one tick" },
      { keys: [","], act: "stage", words: "one stage of a tick" },
      { keys: ["b"], act: "tickBack", words: "a tick back" },
      { keys: ["j"], act: "secondBack", words: "a second back" },
      { keys: ["l"], act: "secondOn", words: "a second on" },
      { keys: ["["], act: "eventBack", words: "event before" },
      { keys: ["]"], act: "eventOn", words: "next event" },
      { keys: ["n"], act: "now", words: "back to now" },
      { keys: ["v"], act: "events", words: "all events" },
      { keys: ["m"], act: "bookmark", words: "bookmark this moment" },
      { keys: ["h"], act: "goOn", words: "go on from the moment shown" },
    ],
  },
  {
    title: "Looking",
    rows: [
      { keys: ["1"], act: "view1", words: "all plates" },
      { keys: ["2"], act: "view2", words: "office" },
      { keys: ["3"], act: "view3", words: "pose cells" },
      { keys: ["4"], act: "view4", words: "map" },
      { keys: ["f"], act: "follow", words: "the camera follows the robot" },
      { keys: ["i"], act: "vision", words: "vision off, or on again" },
      { keys: ["r"], act: "replay", words: "the last loop closure again" },
      { keys: ["p"], act: "panel", words: "show or hide the panel" },
      { keys: ["t"], act: "theme", words: "light or dark" },
    ],
  },
  {
    title: "Presenter",
    rows: [
      { keys: ["z"], act: "present", words: "present, or end it" },
      { keys: ["PageDown"], act: "next", words: "next" },
      { keys: ["PageUp"], act: "back", words: "back" },
      { keys: ["q"], act: "spotlight", words: "spotlight" },
    ],
  },
  {
    title: "Page",
    rows: [
      { keys: ["c"], act: "lessons", words: "lessons" },
      { keys: ["g"], act: "gallery", words: "experiments" },
      { keys: ["o"], act: "edit", words: "edit the office" },
      { keys: ["?"], act: "help", words: "this help" },
      { keys: ["Escape"], act: "escape", words: "close what is open" },
    ],
  },
]);

/** @typedef {(typeof GROUPS)[number]["rows"][number]["act"]} Act */

const BY_KEY = new Map(
  GROUPS.flatMap(({ rows }) => rows.flatMap(({ keys, act }) => keys.map((key) => /** @type {const} */ ([key, act])))),
);

/** What a key does; undefined: nothing. @param {string} key @returns {Act | undefined} */
export const actOf = (key) => BY_KEY.get(/** @type {any} */ (key));

/** A key as it is written on keyboards. @param {string} key */
export const written = (key) => ({ " ": "space", Escape: "esc", PageDown: "page down", PageUp: "page up" })[key] ?? key;

/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {{ code: string, key: string, ctrlKey: boolean, metaKey: boolean, altKey: boolean, isComposing: boolean, shiftKey?: boolean, getModifierState?: (key: string) => boolean }} Pressed */
/**
 * Where the key was pressed: in a place to type, in a widget that uses the arrows, in one that the space bar presses, and while
 * a dialog is open.
 * @typedef {{ typing: boolean, arrows: boolean, pressing: boolean, dialog: boolean }} Where
 */

/** By place. @type {Record<string, Direction>} */
const DRIVE = {
  ArrowUp: "up",
  ArrowDown: "down",
  ArrowLeft: "left",
  ArrowRight: "right",
  KeyW: "up",
  KeyS: "down",
  KeyA: "left",
  KeyD: "right",
};
export const DRIVING = ["KeyW", "KeyA", "KeyS", "KeyD"];
/** A sign of ours that a layout has on one of them, by what it writes with shift. @type {Record<string, string>} */
const SHIFTED = { "<": ",", İ: "i" }; // Dvorak, Turkish F

/** What a US keyboard has in a place, where there is no letter. @type {Record<string, string>} */
const US = { Space: " ", Comma: ",", Period: ".", Slash: "/", BracketLeft: "[", BracketRight: "]" };

/** @param {string} code @param {boolean} shift */
function onUs(code, shift) {
  if (/^Key[A-Z]$/.test(code)) return code[3].toLowerCase();
  if (shift) return code === "Slash" ? "?" : "";
  return /^Digit\d$/.test(code) ? code[5] : (US[code] ?? "");
}

/**
 * The name of the key that is meant, "" for none: the Latin letter or sign that it writes; where it writes none of ours, what a US
 * keyboard has in its place, so that letters are found where Cyrillic, Greek or Arabic is written. A sign may need AltGr, which
 * Windows tells as ctrl and alt, or option on a Mac; letters and digits with those are the browser's.
 * @param {Pressed} event
 */
export function nameOfKey(event) {
  const { code, key, ctrlKey, metaKey, altKey, shiftKey = false } = event;
  const sign = key.length > 1 ? key : (DRIVING.includes(code) && SHIFTED[key]) || key.toLowerCase();
  const us = onUs(code, shiftKey);
  if (metaKey || ctrlKey || altKey) {
    const third = !metaKey && (altKey || Boolean(event.getModifierState?.("AltGraph")));
    return third && /^[^a-z0-9\s]$/.test(sign) && sign !== us ? sign : "";
  }
  return actOf(sign) !== undefined || /^[a-z]$/.test(sign) || !us ? sign : us;
}

/**
 * What a key means there: driving, or the name of an action; null: the key is left to the widget or the browser. Who drives looks
 * at the stage and not at letters, so the four keys lie in the same places on every layout; what a layout writes there is meant
 * with shift (French: ⇧Z presents).
 * @param {Pressed} event
 * @param {Where} where
 * @returns {{ drive: Direction } | { act: string } | null}
 */
export function meaningOf(event, where) {
  const act = event.isComposing || where.typing ? "" : nameOfKey(event);
  if (where.dialog) return act === "?" ? { act } : null;
  if (!act || (act === " " && where.pressing)) return null;
  if (!drives(event)) return { act };
  return where.arrows && event.code.startsWith("Arrow") ? null : { drive: DRIVE[event.code] };
}

/** @param {Pressed} event */
function drives({ code, shiftKey, ctrlKey, metaKey, altKey }) {
  return code.startsWith("Arrow") || (DRIVING.includes(code) && !(shiftKey || ctrlKey || metaKey || altKey));
}

// Widgets that use arrows, space or letters themselves.
const TYPING =
  "input:not([type='checkbox'], [type='radio']), textarea, select, [contenteditable='true'], [role='textbox'], [role='combobox'], [role='listbox'], [role='application']";
const ARROWS =
  "input[type='radio'], [role='slider'], [role='tab'], [role='radio'], [role='menuitem'], [role='spinbutton'], [role='separator']";
const PRESSING = "button, summary, a[href], input:is([type='checkbox'], [type='radio']), [role='button'], [role='tab']";

export class Keys {
  /**
   * `drive(name, down)`: for the driving keys. `act(name)`: for all others; returns whether the key had a meaning. `allUp()`:
   * when keys may have been let go unseen.
   * @param {{ drive: (name: Direction, down: boolean) => void, act: (name: string) => boolean, allUp: () => void }} calls
   */
  constructor({ drive, act, allUp }) {
    this.calls = { drive, act, allUp };
    /** @type {Map<string, Direction>} */
    this.driving = new Map(); // by place: when it is let go, a key may write something else
    this.listen(window);
    document.addEventListener("visibilitychange", () => document.hidden && this.allUp());
    window.addEventListener("pagehide", () => this.allUp());
  }

  /** @param {Window} target */
  listen(target) {
    target.addEventListener("keydown", (event) => this.down(event), true);
    target.addEventListener("keyup", (event) => this.up(event), true);
    // Focus that only moves between the page and its frame is not lost: we listen to both.
    target.addEventListener("blur", () => setTimeout(() => document.hasFocus() || this.allUp()), true);
  }

  /** @param {KeyboardEvent} event */
  down(event) {
    // A dialog that was just closed keeps the focus until the next frame is drawn, but takes no keys any more.
    const is = (/** @type {string} */ kind) => within(event, kind)?.checkVisibility() ?? false;
    const dialog = document.querySelector("dialog[open]") !== null;
    const meaning = meaningOf(event, { typing: is(TYPING), arrows: is(ARROWS), pressing: is(PRESSING), dialog });
    if (!meaning) return;
    if ("drive" in meaning) {
      swallow(event);
      if (event.repeat) return;
      this.driving.set(event.code, meaning.drive);
      this.calls.drive(meaning.drive, true);
    } else if (!event.repeat && this.calls.act(meaning.act)) swallow(event);
  }

  allUp() {
    this.driving.clear();
    this.calls.allUp();
  }

  /** @param {KeyboardEvent} event */
  up(event) {
    const drive = this.driving.get(event.code);
    if (!drive || !this.driving.delete(event.code)) return;
    if (![...this.driving.values()].includes(drive)) this.calls.drive(drive, false);
  }
}

/** @param {Event} event */
function swallow(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}

const PERIOD_MS = 60;
const SPEED = 0.4; // m/s
const TURN = 1.1; // rad/s
const DEAD = 0.18; // a gamepad's stick counts from here on

export class HandDrive {
  /** @typedef {{ speed: number, yaw_rate: number }} Wish */

  /** @param {(command: Drive) => void} send */
  constructor(send) {
    this.send = send;
    /** @type {{ keys: Set<string>, pad: Map<number | string, string> }} pad: by pointer */
    this.held = { keys: new Set(), pad: new Map() };
    /** @type {Wish | null} */
    this.stick = null;
    /** @type {Wish} */
    this.wish = { speed: 0, yaw_rate: 0 };
    /** @type {ReturnType<typeof setInterval> | null} */
    this.timer = null;
    this.listen();
    window.addEventListener("gamepadconnected", () => this.poll());
  }

  /** @returns {NodeListOf<HTMLElement>} */
  get buttons() {
    return document.querySelectorAll("[data-drive]");
  }

  /** @param {Direction} direction @param {boolean} down */
  key(direction, down) {
    if (down) this.held.keys.add(direction);
    else if (!this.held.keys.delete(direction)) return;
    this.changed();
  }

  allUp() {
    this.held.keys.clear();
    this.held.pad.clear();
    this.stick = null;
    this.changed();
  }

  listen() {
    for (const button of this.buttons) {
      const direction = button.dataset.drive ?? "";
      button.addEventListener("pointerdown", (event) => {
        if (event.button > 0) return;
        button.setPointerCapture(event.pointerId);
        this.held.pad.set(event.pointerId, direction);
        this.changed();
      });
      for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"]))
        button.addEventListener(end, (event) => this.held.pad.delete(event.pointerId) && this.changed());
      // Enter or space on a focused button of the pad holds it down, for people who use no pointer.
      button.addEventListener("keydown", (event) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        if (!event.repeat) this.hold(`key ${direction}`, direction);
      });
      button.addEventListener("keyup", () => this.letGo(`key ${direction}`));
      button.addEventListener("blur", () => this.letGo(`key ${direction}`));
      button.addEventListener("contextmenu", (event) => event.preventDefault());
    }
  }

  /** @param {string} who @param {string} direction */
  hold(who, direction) {
    this.held.pad.set(who, direction);
    this.changed();
  }

  /** @param {string} who */
  letGo(who) {
    if (this.held.pad.delete(who)) this.changed();
  }

  changed() {
    const directions = new Set([...this.held.keys, ...this.held.pad.values()]);
    for (const button of this.buttons) button.classList.toggle("held", directions.has(button.dataset.drive ?? ""));
    this.wish = this.stick ?? {
      speed: SPEED * (Number(directions.has("up")) - Number(directions.has("down"))),
      yaw_rate: TURN * (Number(directions.has("left")) - Number(directions.has("right"))),
    };
    const moving = directions.size > 0 || this.stick !== null;
    if (moving) {
      this.say(this.wish);
      this.timer ??= setInterval(() => this.say(this.wish), PERIOD_MS);
    } else if (this.timer !== null) {
      clearInterval(this.timer);
      this.timer = null;
      this.say({ speed: 0, yaw_rate: 0 });
    }
  }

  /** @param {Wish} wish */
  say(wish) {
    this.send({ type: "drive", ...wish });
  }

  poll() {
    const pads = navigator.getGamepads().filter(Boolean);
    if (pads.length === 0) {
      this.stick = null;
      this.changed();
      return;
    }
    const [x, y] = pads[0]?.axes ?? [0, 0];
    const pushed = document.hasFocus() && Math.hypot(x, y) > DEAD;
    const before = this.stick;
    this.stick = pushed ? { speed: -SPEED * clamp(y), yaw_rate: -1.4 * clamp(x) } : null;
    if (before === null && this.stick === null) {
      // nothing to say
    } else if (before === null || this.stick === null) this.changed();
    else this.wish = this.stick;
    requestAnimationFrame(() => this.poll());
  }
}

/** @param {number} value */
function clamp(value) {
  return Math.max(-1, Math.min(1, value));
}

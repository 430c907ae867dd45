// Handles keys before viser sees them, in the page and in the viewer's frame.

import { within } from "../elements/dom.js";
import { meaningOf } from "../model/key_meanings.js";

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
   * @typedef {import("../model/key_meanings.js").Direction} Direction
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

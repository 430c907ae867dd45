// What happens when in a world: what the lines of its script can do, to which things, how times are written, and the fields for a time
// and for a level, in lists that are drawn anew.

import { SCRIPT_ACTIONS } from "../shared.js";
import { labelled, make } from "../ui/elements.js";

/** @typedef {EventItem["do"]} Action */
/** @typedef {"doors" | "lamps" | "boxes"} Actors */

/**
 * What a line of the script can do: its title for people, and the list of the things that it can be done to.
 * @type {Record<Action, { title: string, of?: Actors }>}
 */
export const ACTIONS = {
  open_door: { title: "Door opens", of: "doors" },
  close_door: { title: "Door shuts", of: "doors" },
  lamp_on: { title: "Lamp on", of: "lamps" },
  lamp_off: { title: "Lamp off", of: "lamps" },
  box_appear: { title: "Box appears", of: "boxes" },
  box_vanish: { title: "Box goes", of: "boxes" },
  people_on: { title: "People come" },
  people_off: { title: "People go" },
  daylight: { title: "Daylight" },
};

/**
 * The line as it is written in a file, with what its action needs and nothing else: a name, a level, or neither.
 * @param {Partial<World>} world
 * @param {number} at_s
 * @param {Action} action
 * @param {string | number | null} which
 * @returns {EventItem}
 */
export function line(world, at_s, action, which) {
  const { of } = ACTIONS[action];
  if (action === "daylight") return { at_s, do: action, level: isLevel(which) ? Number(which) : 0.5 };
  if (!of) return { at_s, do: action };
  const names = namesOf(world, of);
  return { at_s, do: action, name: names.includes(String(which)) ? String(which) : (names[0] ?? "") };
}

/** @param {string | number | null} text */
export const isLevel = (text) => text !== null && String(text).trim() !== "" && !Number.isNaN(Number(text));

/** @param {Partial<World>} world @param {Actors} list */
export const namesOf = (world, list) => (world[list] ?? []).map((thing) => thing.name);

/**
 * The steps that give the script's lines about a thing its new name, or delete them when there is none.
 * @param {Partial<World>} world
 * @param {ThingList} list
 * @param {string} name
 * @param {string | null} newName
 */
export function followingLines(world, list, name, newName) {
  /** @type {EditStep[]} */
  const steps = [];
  (world.script ?? []).forEach((item, number) => {
    if (ACTIONS[item.do].of !== list || item.name !== name) return;
    steps.unshift(
      newName === null
        ? { do: "delete", list: "script", number }
        : { do: "change", list: "script", number, item: { ...item, name: newName } },
    );
  });
  return steps; // from the last line to the first, so that the others keep their numbers
}

/** 90, 1:30 or 1:02:30 as seconds; NaN when it is no time. @param {string} text */
export function seconds(text) {
  const parts = text.trim().split(":");
  if (parts.length > 3 || parts.some((part) => !/^\d+(\.\d+)?$/.test(part))) return NaN;
  return Math.round(parts.reduce((sum, part) => sum * 60 + Number(part), 0) * 1000) / 1000;
}

/** 1:30, 1:02:30, 0:04.5. @param {number} at_s */
export function time(at_s) {
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const [whole, rest] = [Math.floor(at_s), Math.round((at_s % 1) * 1000) / 1000];
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const tail = two(whole % 60) + (rest ? String(rest).slice(1) : "");
  return hours ? `${hours}:${two(minutes)}:${tail}` : `${minutes}:${tail}`;
}

/** @param {string} text */
export const NO_TIME = (text) => `“${text}” is no time; write seconds (90), or minutes and seconds (1:30).`;

/** The first thing that a line could do in this world. @param {Partial<World> | null} world @returns {Action} */
export const firstAction = (world) => {
  const possible = SCRIPT_ACTIONS.find((name) => ACTIONS[name].of && namesOf(world ?? {}, ACTIONS[name].of).length);
  return possible ?? "daylight";
};

export const NO_LEVEL = (/** @type {string} */ text) =>
  `“${text}” is no level; write a number from 0, which is dark, to 3. 1 is as painted.`;

/** @param {string} label @param {string} value */
export const timeInput = (label, value) =>
  labelled(
    label,
    make("input", {
      type: "text",
      className: "when",
      value,
      required: true,
      autocomplete: "off",
      inputMode: "text",
      maxLength: 12,
    }),
  );

/** @param {string} label @param {number} value */
export const levelInput = (label, value) =>
  labelled(
    label,
    make("input", {
      type: "number",
      className: "level",
      value: String(value),
      min: "0",
      max: "3",
      step: "any",
      required: true,
    }),
  );

/** @param {Element} input @param {boolean} wrong */
export function mark(input, wrong) {
  if (wrong) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/**
 * Draw a list anew. The focus stays where it was, and so does text that somebody is typing.
 * @param {HTMLElement} list
 * @param {HTMLElement} form gets the focus when the list is empty
 * @param {() => void} draw
 */
export function keepingPlace(list, form, draw) {
  const held = list.contains(document.activeElement) ? /** @type {HTMLInputElement} */ (document.activeElement) : null;
  const number = held?.closest("li")?.dataset.number;
  const kind = held?.classList.contains("remove") ? "remove" : held?.classList[0];
  const [typed, count] = [held?.dataset.typed && held.value, list.children.length];
  draw();
  if (!held) return;
  const row = list.querySelector(`li[data-number="${number}"]`);
  const near = row ?? list.lastElementChild ?? form;
  /** @type {HTMLInputElement | null} */
  const place =
    row?.querySelector(`.${kind}`) ?? near.querySelector(kind === "remove" ? ".remove, .when" : ".what, .when");
  if (typed && row && place && list.children.length === count) {
    place.value = typed;
    place.dataset.typed = "yes";
  }
  place?.focus();
}

// What keys mean. No DOM: the caller says where a key was pressed.

import { actOf } from "./key_table.js";

/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {{ code: string, key: string, ctrlKey: boolean, metaKey: boolean, altKey: boolean, isComposing: boolean, shiftKey?: boolean, getModifierState?: (key: string) => boolean }} Pressed */
/**
 * Where the key was pressed: in a place to type, in a widget that uses the arrows, in one that the space bar presses, and while
 * a dialog is open.
 * @typedef {{ typing: boolean, arrows: boolean, pressing: boolean, dialog: boolean }} Where
 */

/** @type {Record<string, Direction>} */
const DRIVE = {
  ArrowUp: "up",
  ArrowDown: "down",
  ArrowLeft: "left",
  ArrowRight: "right",
  w: "up",
  s: "down",
  a: "left",
  d: "right",
};

/** What a US keyboard has in a place, where there is no letter. @type {Record<string, string>} */
const US = { Space: " ", Comma: ",", Period: ".", Slash: "/", BracketLeft: "[", BracketRight: "]" };

/** @param {string} code @param {boolean} shift */
function onUs(code, shift) {
  if (/^Key[A-Z]$/.test(code)) return code[3].toLowerCase();
  if (shift) return code === "Slash" ? "?" : "";
  return /^Digit\d$/.test(code) ? code[5] : (US[code] ?? "");
}

/** @param {string} name */
const known = (name) => Object.hasOwn(DRIVE, name) || actOf(name) !== undefined;

/**
 * The name of the key that is meant, "" for none. One rule for every layout and script, so that the help is right on all: a key
 * means the Latin letter or sign that it writes; one that writes none of ours means what a US keyboard has in its place. So W A S D
 * lie in their places also where Cyrillic, Greek or Arabic is written, and Z presents wherever it lies. A sign may need AltGr, which
 * Windows tells as ctrl and alt, or option on a Mac; letters and digits with those are the browser's.
 * @param {Pressed} event
 */
export function nameOfKey(event) {
  const { code, key, ctrlKey, metaKey, altKey, shiftKey = false } = event;
  const sign = key.length > 1 ? key : key.toLowerCase();
  const us = onUs(code, shiftKey);
  if (metaKey || ctrlKey || altKey) {
    const third = !metaKey && (altKey || Boolean(event.getModifierState?.("AltGraph")));
    return third && /^[^a-z0-9\s]$/.test(sign) && sign !== us ? sign : "";
  }
  return known(sign) || /^[a-z]$/.test(sign) || !us ? sign : us;
}

/**
 * What a key means there: driving, or the name of an action; null: the key is left to the widget or the browser.
 * @param {Pressed} event
 * @param {Where} where
 * @returns {{ drive: Direction } | { act: string } | null}
 */
export function meaningOf(event, where) {
  const act = event.isComposing || where.typing ? "" : nameOfKey(event);
  if (!act) return null;
  if (where.dialog) return act === "?" ? { act } : null;
  if (Object.hasOwn(DRIVE, act)) return act.startsWith("Arrow") && where.arrows ? null : { drive: DRIVE[act] };
  return act === " " && where.pressing ? null : { act };
}

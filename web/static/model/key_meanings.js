// What keys mean. No DOM: the caller says where a key was pressed.

import { actOf } from "./key_table.js";

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

// What keys mean. No DOM: the caller says where a key was pressed.

/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {{ code: string, key: string, ctrlKey: boolean, metaKey: boolean, altKey: boolean, isComposing: boolean }} Pressed */
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
  KeyW: "up",
  KeyS: "down",
  KeyA: "left",
  KeyD: "right",
};

/** The direction in which a key drives, by its position on the keyboard. @param {string} code @returns {Direction | undefined} */
export const directionOf = (code) => DRIVE[code];

/**
 * What a key means there: driving, or the name of an action; null: the key is left to the widget or the browser.
 * @param {Pressed} event
 * @param {Where} where
 * @returns {{ drive: Direction } | { act: string } | null}
 */
export function meaningOf(event, where) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.isComposing || where.typing) return null;
  const drive = DRIVE[event.code];
  if (drive && !where.dialog) return event.code.startsWith("Arrow") && where.arrows ? null : { drive };
  const act = event.key.length > 1 ? event.key : event.key.toLowerCase();
  if (where.dialog) return act === "?" ? { act } : null;
  return act === " " && where.pressing ? null : { act };
}

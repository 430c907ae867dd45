// Which keys mean what. No DOM: whoever listens says where a key was pressed.

/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {{ code: string, key: string, ctrlKey: boolean, metaKey: boolean, altKey: boolean, isComposing: boolean }} Pressed */
/**
 * What is there where the key was pressed: a place to type, a widget that uses the arrows, one that is pressed with the space
 * bar, and whether a dialog is open.
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

/** The direction that a key drives to, by where it lies on the keyboard. @param {string} code @returns {Direction | undefined} */
export const directionOf = (code) => DRIVE[code];

/**
 * What a key means there: to drive, or the name of something to do; null is for the widget or the browser.
 * @param {Pressed} event
 * @param {Where} where
 * @returns {{ drive: Direction } | { act: string } | null}
 */
export function meaningOf(event, where) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.isComposing || where.typing) return null;
  const drive = DRIVE[event.code];
  if (drive && !where.dialog) return event.code.startsWith("Arrow") && where.arrows ? null : { drive };
  const act = event.key === "?" || event.key === "Escape" ? event.key : event.key.toLowerCase();
  if (where.dialog) return act === "?" ? { act } : null;
  return act === " " && where.pressing ? null : { act };
}

// A click on the plates: a press that is let go where it began. The page sends it itself, not viser, whose client drops it without a
// word while it is not connected, or not yet told that clicks are wanted; here each is answered.

const STILL_PX = 6; // a hand trembles

/**
 * @param {Window} inside
 * @param {(at: Point, shift: boolean) => void} click where, from the middle, to the right and upwards, in halves of the height
 */
export function takeClicks(inside, click) {
  /** @type {PointerEvent | null} */
  let press = null;
  const down = (/** @type {PointerEvent} */ event) => {
    const taken = event.isPrimary && event.button === 0; // a second finger ends what the first one began
    press = taken && /** @type {Element} */ (event.target).tagName === "CANVAS" ? event : null;
  };
  const move = (/** @type {PointerEvent} */ { clientX, clientY }) => {
    if (press && Math.hypot(clientX - press.clientX, clientY - press.clientY) > STILL_PX) press = null;
  };
  const up = (/** @type {PointerEvent} */ { pointerId }) => {
    if (press?.pointerId !== pointerId) return;
    const { left, top, width, height } = /** @type {Element} */ (press.target).getBoundingClientRect();
    const half = height / 2;
    click([(press.clientX - left - width / 2) / half, (top + half - press.clientY) / half], press.shiftKey);
    press = null;
  };
  inside.addEventListener("pointerdown", down, true);
  inside.addEventListener("pointermove", move, true);
  inside.addEventListener("pointerup", up, true);
  inside.addEventListener("pointercancel", () => (press = null), true);
}

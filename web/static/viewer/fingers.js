// A finger on the stage. viser takes a press on its canvas for a click only while nothing has captured the pointer, and a
// finger is captured from its first touch on: it is let go while viser looks, and captured again for the drag to come.

/** @param {Window} inside */
export function freeFingers(inside) {
  const held = new Set();
  inside.addEventListener(
    "pointerdown",
    (event) => {
      const { pointerId } = event;
      const target = /** @type {Element} */ (event.target);
      if (target.tagName !== "CANVAS" || !target.hasPointerCapture(pointerId)) return;
      target.releasePointerCapture(pointerId);
      held.add(pointerId);
    },
    true,
  );
  inside.addEventListener(
    "pointerdown",
    ({ target, pointerId }) => held.delete(pointerId) && /** @type {Element} */ (target).setPointerCapture(pointerId),
  );
}

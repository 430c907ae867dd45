// A finger on the plates. viser takes a press on its canvas for a click only while nothing has captured the pointer, but a
// finger is captured from its first touch. So it is released while viser looks, and captured again for a drag.

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

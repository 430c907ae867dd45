// Two fingers on the plates: a pinch, as on a map. viser's own hardly moves (fingers four times as far apart: 15 % nearer), takes
// a resting thumb for a click, and a thumb on the robot for a drag. So the second finger ends what the first one began, and the
// camera is set here, until the last finger is lifted.

import { pinched } from "../model/pinch.js";

/** @param {Window & typeof globalThis} inside */
export function takePinches(inside) {
  /** @type {Map<number, import("../model/pinch.js").Point>} */
  const fingers = new Map();
  let canvas = inside.document.documentElement; // on which the first finger is
  let pinching = false;

  const place = (/** @type {PointerEvent} */ { clientX, clientY }) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    return /** @type {const} */ ([clientX - left - width / 2, clientY - top - height / 2]);
  };
  const down = (/** @type {PointerEvent} */ event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.pointerType !== "touch" || target.tagName !== "CANVAS") return;
    canvas = target;
    fingers.set(event.pointerId, place(event));
    if (!pinching && fingers.size === 2 && cameraOf(inside)) {
      pinching = true;
      const [pointerId] = fingers.keys();
      target.dispatchEvent(
        new inside.PointerEvent("pointercancel", { pointerId, pointerType: "touch", bubbles: true }),
      );
    }
    if (pinching) event.stopImmediatePropagation();
  };
  const moved = (/** @type {PointerEvent} */ event) => {
    if (!fingers.has(event.pointerId)) return;
    const [a, b] = fingers.values();
    fingers.set(event.pointerId, place(event));
    const [c, d] = fingers.values();
    if (pinching && fingers.size === 2) move(cameraOf(inside), canvas.clientHeight, [a, b], [c, d]);
    if (pinching) event.stopImmediatePropagation();
  };
  // viser's camera has to hear that the first finger is up; to all others it was ended before.
  const up = (/** @type {PointerEvent} */ event) => {
    if (!event.isTrusted || !fingers.has(event.pointerId)) return;
    fingers.delete(event.pointerId);
    if (fingers.size === 0) pinching = false;
  };

  inside.addEventListener("pointerdown", down, true);
  inside.addEventListener("pointermove", moved, true);
  inside.addEventListener("pointerup", up, true);
  inside.addEventListener("pointercancel", up, true);
}

/** viser's camera; null in a version that does not show it to tests, whose own pinch then has to do. @param {any} inside */
const cameraOf = (inside) => inside.__viserMutable?.cameraControl ?? null;

/**
 * @param {any} camera
 * @param {number} height of the picture
 * @param {import("../model/pinch.js").Fingers} before
 * @param {import("../model/pinch.js").Fingers} after
 */
function move(camera, height, before, after) {
  const unit = (2 * Math.tan((camera.camera.fov * Math.PI) / 360)) / height;
  const { distance, right, down } = pinched(before, after, { distance: camera.distance, unit });
  camera.dollyTo(distance, false);
  camera.truck(right, down, false);
}

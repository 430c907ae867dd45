// A click on the plates, and two fingers, as on a map. viser's own client takes neither so.

/**
 * @typedef {readonly [number, number]} Spot pixels, from the middle of the picture, to the right and downwards
 * @typedef {readonly [Spot, Spot]} Fingers
 */

/**
 * Where a camera belongs when two fingers have moved from `before` to `after`: how far from what it looks at, and by how much
 * that is to be moved to the right and downwards.
 * @param {Fingers} before
 * @param {Fingers} after
 * @param {{ distance: number, unit: number }} camera `unit`: how large a pixel is there, at a distance of 1
 */
export function pinched(before, after, { distance, unit }) {
  const nearer = Math.max(spread(after), 1) / Math.max(spread(before), 1);
  const far = distance / nearer;
  const [from, to] = [middle(before), middle(after)];
  return {
    distance: far,
    right: unit * (from[0] * distance - to[0] * far),
    down: unit * (from[1] * distance - to[1] * far),
  };
}

/** @param {Fingers} fingers */
const spread = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** @param {Fingers} fingers */
const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];

const STILL_PX = 6; // a hand trembles

/**
 * A click: a press that is let go where it began. The page sends it itself, not viser, whose client drops it without a word while
 * it is not connected, or not yet told that clicks are wanted; here each is answered.
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

/**
 * A pinch. viser's own hardly moves (fingers four times as far apart: 15 % nearer), takes a resting thumb for a click, and a thumb
 * on the robot for a drag. So the second finger ends what the first one began, and the camera is set here, until the last finger
 * is lifted.
 * @param {Window & typeof globalThis} inside
 */
export function takePinches(inside) {
  /** @type {Map<number, Spot>} */
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
    if (pinching && fingers.size === 2) moveCamera(cameraOf(inside), canvas.clientHeight, [a, b], [c, d]);
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
 * @param {Fingers} before
 * @param {Fingers} after
 */
function moveCamera(camera, height, before, after) {
  const unit = (2 * Math.tan((camera.camera.fov * Math.PI) / 360)) / height;
  const { distance, right, down } = pinched(before, after, { distance: camera.distance, unit });
  camera.dollyTo(distance, false);
  camera.truck(right, down, false);
}

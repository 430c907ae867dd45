// What bends viser's client, the page in our frame: when it draws and with how many pixels, clicks and pinches, and what of it is
// never seen. Each has its test in tests/e2e/test_viser_client.py, on the real client.

const SHARE = 0.75;

/** Who draws in three dimensions in this browser; null: nobody. @returns {string | null} */
export function whoDraws() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return null;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

/** Whether this drawer is no graphics card. @param {string} drawer */
export const isSoftware = (drawer) => /swiftshader|llvmpipe|software/i.test(drawer);

/** viser's own setting of how many pixels it draws in software. */
export const fewerPixels = () => `&fixedDpr=${SHARE * devicePixelRatio}`;

/**
 * Makes a canvas for drawing in software. Returns what tells viser's context, once there is one.
 * @param {Window & typeof globalThis} inside
 * @returns {() => WebGL2RenderingContext | null}
 */
export function spareSoftware(inside) {
  const kind = inside.HTMLCanvasElement.prototype;
  const getContext = kind.getContext;
  /** @type {WebGL2RenderingContext | null} */
  let made = null;
  kind.getContext = /** @type {any} */ (
    /** @this {HTMLCanvasElement} @param {any} name @param {any} options */
    function (name, options) {
      if (name !== "webgl2" || !options?.antialias) return getContext.call(this, name, options);
      made = /** @type {WebGL2RenderingContext} */ (getContext.call(this, name, { ...options, antialias: false }));
      return made;
    }
  );
  return () => made;
}

const WHOLE = 40; // draw calls of a frame with the plates and what is on them, not the sky alone
const DRAWS = ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"];

/**
 * Resolves when viser has drawn a whole frame; never, if it cannot draw.
 * @param {Window & typeof globalThis} inside
 * @returns {Promise<void>}
 */
export function firstFrame(inside) {
  /** @type {any} some of its functions are replaced for a while */
  const kind = inside.WebGL2RenderingContext.prototype;
  const before = DRAWS.map((name) => kind[name]);
  const next = inside.requestAnimationFrame.bind(inside);
  return new Promise((resolve) => {
    let calls = 0;
    for (const [k, name] of DRAWS.entries())
      kind[name] = /** @this {WebGL2RenderingContext} @param {...any} rest */ function (...rest) {
        if (!this.isContextLost()) calls += 1;
        return before[k].apply(this, rest);
      };
    const look = () => {
      if (calls < WHOLE) {
        calls = 0;
        next(look);
        return;
      }
      for (const [k, name] of DRAWS.entries()) kind[name] = before[k];
      resolve();
    };
    next(look);
  });
}

const OFTEN = 20; // nothing but the loop asks as often for the same step
const COVERED_MS = 2000;
const TOUCHED_MS = 1000;
const LOOK_MS = 8;
const HELD_FROM = 1e9; // ids that the browser does not come to, and nobody cancels who has none: viser does so with -1
const LONGEST_MS = 5000; // who is told nothing of a frame for so long never rests again
const TOUCHES = ["pointerdown", "pointermove", "pointerup", "wheel"];

/**
 * Lets viser's loop of frames, recognised by being requested again and again, rest while the editor covers the plates, and in
 * software rendering after each frame for as long as that took: the other half of the time is the page's and the robot's. Who
 * turns the camera does not wait. All else that asks for a frame has it as before. After each frame of the loop there is an event,
 * "drawn": only then can be read what is on the canvas. What this returns wakes the loop at once.
 * @param {Window & typeof globalThis} inside
 * @param {() => boolean} covered
 * @param {() => WebGL2RenderingContext | null} software viser's, if it draws without a graphics card
 */
export function restBetweenFrames(inside, covered, software) {
  const [next, drop] = [inside.requestAnimationFrame.bind(inside), inside.cancelAnimationFrame.bind(inside)];
  /** @type {[WeakMap<FrameRequestCallback, number>, Map<number, FrameRequestCallback>]} */
  const [asked, held] = [new WeakMap(), new Map()];
  let [drawing, silent, last, rest, touched] = [false, false, HELD_FROM, 0, -TOUCHED_MS];
  const now = () => inside.performance.now();

  inside.requestAnimationFrame = (step) => {
    asked.set(step, (asked.get(step) ?? 0) + 1);
    if (/** @type {number} */ (asked.get(step)) < OFTEN) return next(step);
    if (drawing || rest) {
      held.set(++last, step);
      return last;
    }
    return next((at) => draw(step, at));
  };
  inside.cancelAnimationFrame = (id) => held.delete(id) || drop(id);

  /** @param {FrameRequestCallback} step @param {number} at */
  const draw = (step, at) => {
    const [began, gl] = [now(), silent ? null : software()];
    drawing = gl !== null || covered();
    const done = (told = true) => {
      drawing = false;
      silent ||= !told;
      const spent = silent || now() - touched < TOUCHED_MS ? 0 : now() - began;
      rest = inside.setTimeout(wake, covered() ? COVERED_MS : spent);
    };
    try {
      step(at);
      inside.dispatchEvent(new Event("drawn"));
    } finally {
      if (gl) whenDrawn(inside, gl, done);
      else if (drawing) done();
    }
  };
  const wake = () => {
    inside.clearTimeout(rest);
    rest = 0;
    const steps = [...held.values()];
    held.clear();
    for (const step of steps) inside.requestAnimationFrame(step);
  };
  for (const touch of TOUCHES)
    inside.addEventListener(
      touch,
      (event) => {
        if (touch === "pointermove" && !(/** @type {PointerEvent} */ (event).buttons)) return;
        touched = now();
        if (rest && !covered()) wake();
      },
      { capture: true, passive: true },
    );
  return wake;
}

/**
 * Calls back when all is drawn that was asked for, or when nothing is told of it for too long.
 * @param {Window & typeof globalThis} inside
 * @param {WebGL2RenderingContext} gl
 * @param {(told: boolean) => void} done
 */
function whenDrawn(inside, gl, done) {
  const [fence, until] = [gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), inside.performance.now() + LONGEST_MS];
  gl.flush();
  const look = () => {
    const told = !fence || gl.isContextLost() || gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
    if (!told && inside.performance.now() < until) return void inside.setTimeout(look, LOOK_MS);
    if (fence) gl.deleteSync(fence);
    done(told);
  };
  look();
}

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

const REST_MS = 110; // between two messages of where the mouse is

/**
 * Tells where the mouse points, as a click would; null: no longer. A finger points at nothing.
 * @param {Window & typeof globalThis} inside @param {(at: Point | null) => void} point
 */
export function takeHovers(inside, point) {
  let next_ms = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let later;
  const at = (/** @type {PointerEvent} */ { target, clientX, clientY }) => {
    const { left, top, width, height } = /** @type {Element} */ (target).getBoundingClientRect();
    point([(clientX - left - width / 2) / (height / 2), (top + height / 2 - clientY) / (height / 2)]);
    next_ms = performance.now() + REST_MS;
  };
  const move = (/** @type {PointerEvent} */ event) => {
    clearTimeout(later);
    const points = event.pointerType === "mouse" && event.buttons === 0;
    if (!points || /** @type {Element} */ (event.target).tagName !== "CANVAS") return;
    later = setTimeout(() => at(event), Math.max(0, next_ms - performance.now()));
  };
  inside.addEventListener("pointermove", move, true);
  inside.document.documentElement.addEventListener("pointerleave", () => {
    clearTimeout(later);
    point(null);
  });
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

/** viser reconnects only if its own frame has the focus when the connection goes; people may look elsewhere by then. @param {Document} paper */
export function keepConnected(paper) {
  paper.hasFocus = () => true;
}

/**
 * viser prevents the default of a press on a draggable thing in a passive listener. That has no effect, but the browser logs an
 * error each time.
 * @param {Window} inside
 */
export function hushPresses(inside) {
  inside.addEventListener(
    "pointerdown",
    (event) => {
      if (/** @type {Element} */ (event.target).tagName === "CANVAS") event.preventDefault = () => {};
    },
    true,
  );
}

const HIDE_PANEL =
  ".mantine-Paper-root[style*='fixed'], [data-dock-root] > div:not(:has(> canvas)) { display: none !important; }";

/** viser has a panel even when nothing is in it. @param {Document} paper */
export function hidePanel(paper) {
  const style = paper.createElement("style");
  style.textContent = HIDE_PANEL;
  paper.head.append(style);
}

/**
 * viser covers our view buttons for good with a message that there is no graphics card; a short sentence is enough. Returns whether
 * it was there.
 * @param {Document} paper
 */
export function dismissSlowNotice(paper) {
  for (const title of paper.querySelectorAll(".mantine-Notification-title")) {
    if (!(title.textContent ?? "").startsWith("Software WebGL")) continue;
    title.closest(".mantine-Notification-root, .mantine-Notifications-notification")?.querySelector("button")?.click();
    return true;
  }
  return false;
}

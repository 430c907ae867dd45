// How viser draws: with fewer pixels without a graphics card, and when. That it is there, or has a context, does not tell that
// it has drawn.

// Without a graphics card a frame takes most of a second. A third of that goes into smooth edges, in a picture that is drawn at
// three quarters of its size and then enlarged. There, viser's canvas is made without them; its lines are smooth all the same.
// It comes to three quarters by itself, but only after seconds of slow frames, so there it begins with them.
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

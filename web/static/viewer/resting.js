// When viser draws. Its loop of frames, recognised by being requested again and again, rests while the editor covers the plates,
// and in software rendering after each frame for as long as that took: the other half of the time is the page's and the robot's.
// Who turns the camera does not wait. All else that asks for a frame has it as before. After each frame of the loop there is an
// event, "drawn": only then can be read what is on the canvas.

const OFTEN = 20; // nothing but the loop asks as often for the same step
const COVERED_MS = 2000;
const TOUCHED_MS = 1000;
const LOOK_MS = 8;
const HELD_FROM = 1e9; // ids that the browser does not come to, and nobody cancels who has none: viser does so with -1
const LONGEST_MS = 5000; // who is told nothing of a frame for so long never rests again
const TOUCHES = ["pointerdown", "pointermove", "pointerup", "wheel"];

/**
 * Lets the loop rest. What it returns wakes it at once.
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

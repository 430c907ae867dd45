// Without a graphics card a frame takes most of a second. A third of that goes into smooth edges, in a picture that is drawn at
// three quarters of its size and then enlarged. There, viser's canvas is made without them; its lines are smooth all the same.
// It comes to three quarters by itself, but only after seconds of slow frames, so there it begins with them.

const SHARE = 0.75;

const drawer = whoDraws();

/** Whether this browser draws in three dimensions at all. */
export const hasWebgl = drawer !== null;

const inSoftware = /swiftshader|llvmpipe|software/i.test(drawer ?? "");

/** viser's own setting of how many pixels it draws. */
export const fewerPixels = () => (inSoftware ? `&fixedDpr=${SHARE * devicePixelRatio}` : "");

/**
 * Returns what tells viser's context, once there is one, if it is drawn in software.
 * @param {Window & typeof globalThis} inside
 * @returns {() => WebGL2RenderingContext | null}
 */
export function spareSoftware(inside) {
  if (!inSoftware) return () => null;
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

function whoDraws() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return null;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

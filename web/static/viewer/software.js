// Without a graphics card a frame takes most of a second. A third of that goes into smooth edges, in a picture that is drawn at
// three quarters of its size and then enlarged. There, viser's canvas is made without them; its lines are smooth all the same.

/** @param {Window & typeof globalThis} inside */
export function spareSoftware(inside) {
  const kind = inside.HTMLCanvasElement.prototype;
  const getContext = kind.getContext;
  kind.getContext = /** @type {any} */ (
    /** @this {HTMLCanvasElement} @param {any} name @param {any} options */
    function (name, options) {
      const plain = name === "webgl2" && options?.antialias && inSoftware();
      return getContext.call(this, name, plain ? { ...options, antialias: false } : options);
    }
  );
}

function inSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const drawer = info && gl ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(drawer);
}

// Whether viser has drawn: that it is there, or has a context, tells nothing of that.

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

// A drawing of the plates in their place, from the first paint until viser has drawn a whole frame; then it fades.

import { $ } from "../elements/dom.js";

const WHOLE = 40; // draw calls of a frame with the plates and what is on them, not the sky alone
const DRAWS = ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"];
const LONGEST_MS = 30_000;
const FADE_MS = 400;
const ANEW_MS = 4000;

/**
 * Resolves when viser has drawn a whole frame, or in any case after a while, so that viser's own messages can be seen.
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
        calls += 1;
        return before[k].apply(this, rest);
      };
    const done = () => {
      for (const [k, name] of DRAWS.entries()) kind[name] = before[k];
      inside.clearTimeout(late);
      resolve();
    };
    const late = inside.setTimeout(done, LONGEST_MS);
    const look = () => {
      if (calls >= WHOLE) done();
      else {
        calls = 0;
        next(look);
      }
    };
    next(look);
  });
}

/**
 * Shows the stage as the server draws it, in place of the outlines, and anew from time to time, until viser has drawn it.
 * @param {ViewName} view
 * @param {Theme} theme
 */
export async function showPicture(view, theme) {
  const drawing = $("waiting");
  while (!drawing.hidden && !drawing.classList.contains("over")) {
    const { width, height } = drawing.getBoundingClientRect();
    const aspect = Math.min(Math.max(width / Math.max(height, 1), 0.2), 6);
    const answer = await fetch(`/api/stage.svg?view=${view}&theme=${theme}&aspect=${aspect.toFixed(3)}`).catch(
      () => null,
    );
    if (answer?.status === 200) {
      const picture = new DOMParser().parseFromString(await answer.text(), "image/svg+xml").documentElement;
      picture.classList.add("picture");
      drawing.querySelector(".picture")?.remove();
      drawing.append(document.importNode(picture, true));
      drawing.classList.add("pictured");
    }
    await new Promise((later) => setTimeout(later, ANEW_MS));
  }
}

export function fadeDrawing() {
  const drawing = $("waiting");
  drawing.classList.add("over");
  setTimeout(() => (drawing.hidden = true), FADE_MS);
}

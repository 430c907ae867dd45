// The plates as the server draws them (SVG), in the stage's place: from the first paint until viser has drawn a frame, and whenever
// it cannot draw. The drawing goes on with the run, and a click on it is one on the plates.

import { $, find } from "../ui/elements.js";
import { toast } from "../ui/words.js";

const ANEW_MS = 1000; // a picture costs the server some hundredths of a second
const FADE_MS = 400;
const UNITS = 500; // of the picture, from its middle to its upper edge

export class Drawing {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {{ view: ViewName, click: (at: Point, shift: boolean, drawn: Drawn | null) => void }} viewer
   */
  constructor(link, viewer) {
    this.link = link;
    this.viewer = viewer;
    this.box = $("waiting");
    /** @type {Drawn | null} */
    this.drawn = null; // what the picture shows
    this.busy = this.old = false;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.fading = undefined;
    link.on("state", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.box);
    new MutationObserver(() => this.draw()).observe(document.documentElement, { attributeFilter: ["data-theme"] });
    this.box.addEventListener("click", (event) => this.clicked(event));
  }

  /** @param {string} words what is missing, and why */
  show(words) {
    clearTimeout(this.fading);
    this.box.hidden = false;
    this.box.classList.remove("over");
    this.say(words);
    this.draw();
  }

  /** @param {string} words */
  say(words) {
    find(this.box, ".words").textContent = words;
  }

  fade() {
    this.box.classList.add("over");
    this.fading = setTimeout(() => (this.box.hidden = true), FADE_MS);
  }

  /** Of another program. */
  forget() {
    this.box.querySelector(".picture")?.remove();
    this.box.classList.remove("pictured");
    this.drawn = null;
  }

  async draw() {
    this.old = true;
    if (this.busy || this.box.hidden || this.box.classList.contains("over")) return;
    this.busy = true;
    this.old = false;
    await this.fetch();
    setTimeout(() => {
      this.busy = false;
      if (this.old) this.draw();
    }, ANEW_MS);
  }

  async fetch() {
    const { view } = this.viewer;
    const theme = document.documentElement.dataset.theme ?? "dark";
    const { width, height } = this.box.getBoundingClientRect();
    const aspect = Math.min(Math.max(width / Math.max(height, 1), 0.2), 6).toFixed(2);
    const answer = await fetch(`/api/stage.svg?view=${view}&theme=${theme}&aspect=${aspect}`).catch(() => null);
    if (answer?.status !== 200) return;
    const picture = new DOMParser().parseFromString(await answer.text(), "image/svg+xml").documentElement;
    picture.classList.add("picture");
    this.forget();
    this.box.append(document.importNode(picture, true));
    this.box.classList.add("pictured");
    this.drawn = { view, aspect: Number(aspect) };
  }

  /** @param {MouseEvent} event */
  clicked({ clientX, clientY, shiftKey }) {
    if (this.link.watches) return;
    const picture = /** @type {SVGSVGElement | null} */ (this.box.querySelector(".picture"));
    const placed = picture?.getScreenCTM();
    if (!placed)
      return void toast("No goal set: the drawing is still to come. Click again in a moment.", { bad: true });
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(placed.inverse());
    this.viewer.click([x / UNITS, -y / UNITS], shiftKey, this.drawn);
  }
}

// The plates in 3-D: viser's client in a frame of our own origin, and the view buttons. The frame belongs to one program and one
// graphics context; when either is another, it is thrown away and built anew. While it has drawn nothing, the drawing stands there.

import { $, find, say } from "../ui/elements.js";
import { toast } from "../ui/words.js";
import {
  dismissSlowNotice,
  fewerPixels,
  firstFrame,
  hidePanel,
  hushPresses,
  isSoftware,
  keepConnected,
  restBetweenFrames,
  spareSoftware,
  takeClicks,
  takeHovers,
  takePinches,
  whoDraws,
} from "./viser_client.js";

const LATE_MS = 20_000;
const ON = "turn on hardware acceleration in the browser's settings and load this page again.";
const WORDS = {
  waking: "Waking the stage",
  late: `The stage has drawn nothing yet; until it does, this is a drawing. If it stays so, ${ON}`,
  off: `No WebGL in this browser, so this is a drawing; a click on the map sets a goal all the same. For the stage in 3-D, ${ON}`,
  lost: "The browser has taken the graphics away; until they are back, this is a drawing.",
};

export const phone = () => window.matchMedia("(max-width: 760px), (pointer: coarse) and (max-height: 500px)").matches;

export class Viewer extends EventTarget {
  /** @param {import("../net/connection.js").Connection} link @param {import("../ui/keys.js").Keys} keys */
  constructor(link, keys) {
    super();
    this.link = link;
    this.keys = keys;
    this.frame = $("stage");
    this.drawer = whoDraws();
    this.soft = this.drawer !== null && isSoftware(this.drawer);
    /** @type {ViewName} */
    this.view = phone() ? "map" : "all";
    /** @type {number | string | null} */
    this.launch = null; // the server's, to notice that it has started anew
    this.buttons = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[data-view]")]);
    for (const button of this.buttons)
      button.addEventListener("click", () => this.show(/** @type {ViewName} */ (button.dataset.view)));
    this.mark();
    this.makeRoom();
    this.drawing = new Drawing(link, this);
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this.late = undefined;
    this.frame.addEventListener("load", () => this.loaded());
    this.build();
    link.on("hello", (/** @type {{ launch: number | string }} */ detail) => this.hello(detail));
    link.on("hint", (/** @type {{ words: string }} */ { words }) => this.hint(words));
  }

  build() {
    clearTimeout(this.late);
    this.frame.classList.remove("awake");
    this.drawing.show(this.drawer === null ? WORDS.off : WORDS.waking);
    if (this.drawer === null) return;
    this.late = setTimeout(() => this.drawing.say(WORDS.late), LATE_MS);
    const path = `/viser/?websocket=ws://${location.host}/viser/ws/${this.link.page}&hideViserLogo${this.soft ? fewerPixels() : ""}`;
    this.frame.contentWindow?.location.replace(path); // not a page more to go back through
  }

  lost() {
    this.frame.classList.remove("awake");
    this.drawing.show(WORDS.lost);
  }

  /** @param {ViewName} view @param {CameraAt | null} camera where it had been turned from there */
  show(view, camera = null) {
    this.view = view;
    this.mark();
    this.drawing.draw();
    this.dispatchEvent(new Event("view"));
    this.link.send(camera ? { type: "camera", name: view, at: camera } : { type: "view", name: view });
  }

  /** The stage has what the buttons above it and the figures of two brains beneath it leave. */
  makeRoom() {
    const main = /** @type {HTMLElement} */ (this.frame.parentElement);
    const bar = /** @type {HTMLElement} */ (find(main, ".stage-bar"));
    const measure = () => {
      const { offsetTop, offsetHeight } = $("beside");
      main.style.setProperty("--above", `${bar.offsetTop + bar.offsetHeight}px`);
      main.style.setProperty("--below", `${offsetHeight ? main.clientHeight - offsetTop : 0}px`);
    };
    for (const part of [main, bar, $("beside")]) new ResizeObserver(measure).observe(part);
  }

  mark() {
    document.body.dataset.plate = this.view;
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.view === this.view));
  }

  /** Where, in halves of the height from the middle. Resolves when it is answered. @param {Point} at @param {boolean} shift @param {Drawn | null} drawn */
  async click(at, shift, drawn = null) {
    const asked = this.link.ask({ type: "click", at, shift, drawn });
    this.dispatchEvent(new CustomEvent("chosen", { detail: asked }));
    const answer = await asked;
    if (!answer.accepted && !answer.detail.length)
      toast("The click did not arrive: the connection is lost. Click again.", { bad: true });
  }

  /** What a click there would do is told beneath the stage. @param {Point | null} at */
  hover(at) {
    if (at) this.link.send({ type: "hover", at });
    else this.hint("");
  }

  /** @param {string} words */
  hint(words) {
    $("hover").hidden = !words;
    say($("hover"), words);
    const paper = this.frame.contentDocument;
    if (paper) paper.documentElement.style.cursor = words ? "pointer" : "";
  }

  // A program that has started anew knows no view. After a mere loss of the connection, it still shows the same one.
  /** @param {{ launch: number | string }} hello */
  hello({ launch }) {
    if (launch === this.launch) return;
    if (this.launch !== null) {
      this.drawing.forget();
      this.build();
    }
    this.launch = launch;
    this.link.send({ type: "view", name: this.view });
  }

  loaded() {
    const inside = /** @type {(Window & typeof globalThis) | null} */ (this.frame.contentWindow);
    const paper = this.frame.contentDocument;
    if (!paper || !inside || inside.location.href === "about:blank") return;
    keepConnected(paper);
    inside.addEventListener("webglcontextlost", () => this.lost(), true);
    inside.addEventListener("webglcontextrestored", () => this.build(), true);
    firstFrame(inside).then(() => this.wake(paper)); // it looks at every frame, before the loop of them may rest
    const editor = $("editor");
    const wake = restBetweenFrames(inside, () => !editor.hidden, this.soft ? spareSoftware(inside) : () => null);
    new MutationObserver(wake).observe(editor, { attributeFilter: ["hidden"] });
    takePinches(inside);
    if (!this.link.watches) {
      takeClicks(inside, (at, shift) => this.click(at, shift));
      takeHovers(inside, (at) => this.hover(at));
    }
    this.keys.listen(inside);
    this.dispatchEvent(new Event("inside"));
    hushPresses(inside);
    hidePanel(paper);
  }

  /** @param {Document} paper */
  wake(paper) {
    clearTimeout(this.late);
    this.frame.classList.add("awake");
    this.drawing.fade();
    let looks = 20;
    const timer = setInterval(() => {
      const slow = dismissSlowNotice(paper);
      if (slow) this.dispatchEvent(new Event("slow"));
      if (slow || --looks === 0) clearInterval(timer);
    }, 250);
  }
}

const ANEW_MS = 1000; // a picture costs the server some hundredths of a second
const FADE_MS = 400;
const UNITS = 500; // of the picture, from its middle to its upper edge

/**
 * The plates as the server draws them (SVG), in the stage's place: from the first paint until viser has drawn a frame, and whenever
 * it cannot draw. The drawing goes on with the run, and a click on it is one on the plates.
 */
class Drawing {
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

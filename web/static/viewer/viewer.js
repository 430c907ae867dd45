// The plates in 3-D: viser's client in a frame of our own origin, and the view buttons.

import { $ } from "../elements/dom.js";
import { freeFingers } from "./fingers.js";
import { takePinches } from "./pinch.js";
import { restBetweenFrames } from "./resting.js";
import { fewerPixels, spareSoftware } from "./software.js";
import { fadeDrawing, firstFrame } from "./waking.js";

export const phone = window.matchMedia("(max-width: 760px), (pointer: coarse) and (max-height: 500px)");

export class Viewer extends EventTarget {
  /** @param {import("../net/connection.js").Connection} link @param {import("../driving/keys.js").Keys} keys */
  constructor(link, keys) {
    super();
    this.link = link;
    this.keys = keys;
    this.frame = $("stage");
    /** @type {ViewName} */
    this.view = phone.matches ? "map" : "all";
    /** @type {number | string | null} */
    this.launch = null; // the server's, to notice that it has started anew
    this.buttons = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("[data-view]")]);
    for (const button of this.buttons)
      button.addEventListener("click", () => this.show(/** @type {ViewName} */ (button.dataset.view)));
    this.mark();
    this.frame.addEventListener("load", () => this.loaded());
    this.frame.src = `/viser/?websocket=ws://${location.host}/viser/ws/${link.page}&hideViserLogo${fewerPixels()}`;
    link.on("hello", (/** @type {{ launch: number | string }} */ detail) => this.hello(detail));
  }

  /** @param {ViewName} view @param {CameraAt | null} camera where it had been turned from there */
  show(view, camera = null) {
    this.view = view;
    this.mark();
    this.dispatchEvent(new Event("view"));
    this.link.tell(camera ? { type: "camera", name: view, at: camera } : { type: "view", name: view });
  }

  mark() {
    document.body.dataset.plate = this.view;
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.view === this.view));
  }

  // A server that has started anew knows no view. After a mere loss of the connection, it still shows the same one.
  /** @param {{ launch: number | string }} hello */
  hello({ launch }) {
    if (launch === this.launch) return;
    this.launch = launch;
    this.link.tell({ type: "view", name: this.view });
  }

  loaded() {
    const inside = /** @type {(Window & typeof globalThis) | null} */ (this.frame.contentWindow);
    const paper = this.frame.contentDocument;
    if (!paper || !inside || inside.location.href === "about:blank") return;
    // viser reconnects only while its own frame has the focus, but people look at the page as a whole.
    paper.hasFocus = () => !document.hidden;
    firstFrame(inside).then(() => this.wake(paper)); // it looks at every frame, before the loop of them may rest
    const editor = $("editor");
    const wake = restBetweenFrames(inside, () => !editor.hidden, spareSoftware(inside));
    new MutationObserver(wake).observe(editor, { attributeFilter: ["hidden"] });
    takePinches(inside);
    freeFingers(inside);
    this.keys.listen(inside);
    this.dispatchEvent(new Event("inside"));
    // viser prevents the default of a press on a draggable thing in a passive listener. That has no effect, but the
    // browser logs an error each time.
    inside.addEventListener(
      "pointerdown",
      (event) => {
        if (/** @type {Element} */ (event.target).tagName === "CANVAS") event.preventDefault = () => {};
      },
      true,
    );
    const style = paper.createElement("style"); // viser has a panel even when nothing is in it
    style.textContent = HIDE_PANEL;
    paper.head.append(style);
  }

  /** @param {Document} paper */
  wake(paper) {
    this.frame.classList.add("awake");
    fadeDrawing();
    let looks = 20;
    const timer = setInterval(() => {
      const slow = dismissSlowNotice(paper);
      if (slow) this.dispatchEvent(new Event("slow"));
      if (slow || --looks === 0) clearInterval(timer);
    }, 250);
  }
}

const HIDE_PANEL =
  ".mantine-Paper-root[style*='fixed'], [data-dock-root] > div:not(:has(> canvas)) { display: none !important; }";

/** @param {Document} paper */
// viser covers our view buttons for good with a message that there is no graphics card; a short sentence is enough.
function dismissSlowNotice(paper) {
  for (const title of paper.querySelectorAll(".mantine-Notification-title")) {
    if (!(title.textContent ?? "").startsWith("Software WebGL")) continue;
    title.closest(".mantine-Notification-root, .mantine-Notifications-notification")?.querySelector("button")?.click();
    return true;
  }
  return false;
}

// The presenter's mode: the panel away, larger type, a spotlight that follows the pointer, next and back by a clicker's keys.

import { $ } from "../ui/elements.js";

const VIEWS = /** @type {const} */ (["all", "office", "pose", "map"]);

export class Presenter {
  /**
   * @param {import("../viewer/viewer.js").Viewer} viewer
   * @param {import("../panel/panel.js").Panel} panel
   * @param {import("../net/connection.js").Connection} link
   */
  constructor(viewer, panel, link) {
    this.viewer = viewer;
    this.panel = panel;
    this.link = link;
    this.panelWas = panel.shown;
    link.on("hello", () => this.on && link.tell({ type: "present", on: true }));
    link.on("presenting", (/** @type {{ on: boolean }} */ { on }) => this.turn(on)); // heard by those who look on
    $("presenter-end").addEventListener("click", () => this.turn(false));
    $("spotlight").addEventListener("click", () => this.light(!this.lit));
    $("presenter-next").addEventListener("click", () => this.go(1));
    $("presenter-back").addEventListener("click", () => this.go(-1));
    document.addEventListener("pointermove", (event) => this.point(event.clientX, event.clientY));
    viewer.addEventListener("inside", () =>
      viewer.frame.contentWindow?.addEventListener("pointermove", ({ clientX, clientY }) => {
        const { left, top } = viewer.frame.getBoundingClientRect();
        this.point(left + clientX, top + clientY);
      }),
    );
  }

  get on() {
    return document.body.dataset.presenter === "true";
  }

  get lit() {
    return !$("spot").hidden;
  }

  /** @param {boolean} on */
  turn(on) {
    if (on === this.on) return;
    document.body.dataset.presenter = String(on);
    this.link.tell({ type: "present", on });
    if (on) this.panelWas = this.panel.shown;
    this.panel.show(on ? false : this.panelWas);
    $("presenter-bar").hidden = !on || this.link.watches;
    $("present").setAttribute("aria-pressed", String(on));
    if (!on) this.light(false);
  }

  /** @param {boolean} on */
  light(on) {
    $("spot").hidden = !on;
    $("spotlight").setAttribute("aria-pressed", String(on));
  }

  /** @param {number} x @param {number} y */
  point(x, y) {
    if (!this.lit) return;
    const { left, top } = $("spot").getBoundingClientRect();
    $("spot").style.setProperty("--x", `${x - left}px`);
    $("spot").style.setProperty("--y", `${y - top}px`);
  }

  /**
   * On or back: whoever has something to go through, such as a lesson, takes it; else the views, one after the other. Also
   * returns whether the key had a meaning.
   * @param {1 | -1} step
   */
  go(step) {
    if (!this.on) return false;
    const name = step > 0 ? "presenter:next" : "presenter:back";
    if (document.dispatchEvent(new Event(name, { cancelable: true }))) {
      const at = VIEWS.indexOf(this.viewer.view) + step;
      if (VIEWS[at]) this.viewer.show(VIEWS[at]);
    }
    return true;
  }
}

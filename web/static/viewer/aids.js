// What helps to see on the stage, and to show it: a camera that goes with the robot, vision off and on, the last loop closure
// once more; the presenter's mode with the panel away, larger type and a spotlight.

import { $, find } from "../ui/elements.js";
import { clock } from "../ui/words.js";
import { VIEWS } from "../shared.js";

export class Aids {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {import("./viewer.js").Viewer} viewer
   * @param {(wish: Command, done?: string) => Promise<boolean>} command
   */
  constructor(link, viewer, command) {
    this.link = link;
    this.command = command;
    this.following = this.seeing = false;
    /** @type {number | null} */
    this.event = null;
    $("follow").addEventListener("click", () => this.follow(!this.following));
    $("vision").addEventListener("click", () => this.see(!this.seeing));
    $("replay").addEventListener("click", () => this.replay());
    viewer.addEventListener("view", () => this.mark(false)); // a view button takes the camera elsewhere
    link.on("hello", () => this.following && link.send({ type: "follow", on: true }));
  }

  /** @param {boolean} on */
  follow(on) {
    this.mark(on);
    this.link.send({ type: "follow", on });
  }

  /** @param {boolean} on */
  mark(on) {
    this.following = on;
    $("follow").setAttribute("aria-pressed", String(on));
  }

  /** Vision off: the local view gets nothing, and odometry alone moves the packet. @param {boolean} on */
  see(on) {
    const done = on ? "It sees again." : "Vision is off: it goes by its wheels alone. The same click brings it back.";
    this.command({ type: "set_parameter", name: "local_view.enabled", value: on }, done);
  }

  replay() {
    if (this.event !== null) this.link.send({ type: "replay", event: this.event });
  }

  /** @param {PageFields} page */
  show({ vision, closure }) {
    if (vision !== this.seeing) {
      this.seeing = vision;
      $("vision").setAttribute("aria-pressed", String(vision));
      find($("vision"), ".label").textContent = vision ? "Vision" : "Vision off";
      find($("vision"), "use").setAttribute("href", vision ? "#i-eye" : "#i-no-eye");
    }
    const event = closure?.event ?? null;
    $("replay").hidden = event === null;
    this.event = event;
    if (!closure) return;
    const words = `Loop closed at ${clock(closure.time_s)}: it moved the map by ${closure.moved_m.toFixed(1)} m. Play it again slowly (r)`;
    if ($("replay").title !== words) $("replay").title = words;
  }
}

/** The presenter's mode: the panel away, larger type, a spotlight that follows the pointer, next and back by a clicker's keys. */
export class Presenter {
  /**
   * @param {import("./viewer.js").Viewer} viewer
   * @param {import("../panel/panel.js").Panel} panel
   * @param {import("../net/connection.js").Connection} link
   */
  constructor(viewer, panel, link) {
    this.viewer = viewer;
    this.panel = panel;
    this.link = link;
    this.panelWas = panel.shown;
    link.on("hello", () => this.on && link.send({ type: "present", on: true }));
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
    this.link.send({ type: "present", on });
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

// What helps to see on the stage: a camera that goes with the robot, vision off and on, and the last loop closure once more.

import { $, find } from "../ui/elements.js";
import { clock } from "../ui/words.js";

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
    link.on("hello", () => this.following && link.tell({ type: "follow", on: true }));
  }

  /** @param {boolean} on */
  follow(on) {
    this.mark(on);
    this.link.tell({ type: "follow", on });
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
    if (this.event !== null) this.link.tell({ type: "replay", event: this.event });
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

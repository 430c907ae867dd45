// Driving by hand: keys, the pad on the page, a gamepad. While anything is held down, a drive command is sent sixteen times a
// second; letting go sends one stop. The engine lets a drive expire after 0.3 s, so silence stops the robot, too.

const PERIOD_MS = 60;
const SPEED = 0.4; // m/s
const TURN = 1.1; // rad/s
const DEAD = 0.18; // a gamepad's stick counts from here on

export class HandDrive {
  /** @typedef {{ speed: number, yaw_rate: number }} Wish */
  /** @typedef {import("./keys.js").Direction} Direction */

  /** @param {(command: Drive) => void} send */
  constructor(send) {
    this.send = send;
    /** @type {{ keys: Set<string>, pad: Map<number | string, string> }} pad: by pointer */
    this.held = { keys: new Set(), pad: new Map() };
    /** @type {Wish | null} */
    this.stick = null;
    /** @type {Wish} */
    this.wish = { speed: 0, yaw_rate: 0 };
    /** @type {ReturnType<typeof setInterval> | null} */
    this.timer = null;
    this.listen();
    window.addEventListener("gamepadconnected", () => this.poll());
  }

  /** @returns {NodeListOf<HTMLElement>} */
  get buttons() {
    return document.querySelectorAll("[data-drive]");
  }

  /** @param {Direction} direction @param {boolean} down */
  key(direction, down) {
    if (down) this.held.keys.add(direction);
    else if (!this.held.keys.delete(direction)) return;
    this.changed();
  }

  allUp() {
    this.held.keys.clear();
    this.held.pad.clear();
    this.stick = null;
    this.changed();
  }

  listen() {
    for (const button of this.buttons) {
      const direction = button.dataset.drive ?? "";
      button.addEventListener("pointerdown", (event) => {
        if (event.button > 0) return;
        button.setPointerCapture(event.pointerId);
        this.held.pad.set(event.pointerId, direction);
        this.changed();
      });
      for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"]))
        button.addEventListener(end, (event) => this.held.pad.delete(event.pointerId) && this.changed());
      // Enter or space on a focused button of the pad holds it down, for people who use no pointer.
      button.addEventListener("keydown", (event) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        if (!event.repeat) this.hold(`key ${direction}`, direction);
      });
      button.addEventListener("keyup", () => this.letGo(`key ${direction}`));
      button.addEventListener("blur", () => this.letGo(`key ${direction}`));
      button.addEventListener("contextmenu", (event) => event.preventDefault());
    }
  }

  /** @param {string} who @param {string} direction */
  hold(who, direction) {
    this.held.pad.set(who, direction);
    this.changed();
  }

  /** @param {string} who */
  letGo(who) {
    if (this.held.pad.delete(who)) this.changed();
  }

  changed() {
    const directions = new Set([...this.held.keys, ...this.held.pad.values()]);
    for (const button of this.buttons) button.classList.toggle("held", directions.has(button.dataset.drive ?? ""));
    this.wish = this.stick ?? {
      speed: SPEED * (Number(directions.has("up")) - Number(directions.has("down"))),
      yaw_rate: TURN * (Number(directions.has("left")) - Number(directions.has("right"))),
    };
    const moving = directions.size > 0 || this.stick !== null;
    if (moving) {
      this.say(this.wish);
      this.timer ??= setInterval(() => this.say(this.wish), PERIOD_MS);
    } else if (this.timer !== null) {
      clearInterval(this.timer);
      this.timer = null;
      this.say({ speed: 0, yaw_rate: 0 });
    }
  }

  /** @param {Wish} wish */
  say(wish) {
    this.send({ type: "drive", ...wish });
  }

  poll() {
    const pads = navigator.getGamepads().filter(Boolean);
    if (pads.length === 0) {
      this.stick = null;
      this.changed();
      return;
    }
    const [x, y] = pads[0]?.axes ?? [0, 0];
    const pushed = document.hasFocus() && Math.hypot(x, y) > DEAD;
    const before = this.stick;
    this.stick = pushed ? { speed: -SPEED * clamp(y), yaw_rate: -1.4 * clamp(x) } : null;
    if (before === null && this.stick === null) {
      // nothing to say
    } else if (before === null || this.stick === null) this.changed();
    else this.wish = this.stick;
    requestAnimationFrame(() => this.poll());
  }
}

/** @param {number} value */
function clamp(value) {
  return Math.max(-1, Math.min(1, value));
}

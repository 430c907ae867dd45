// Which keys mean what, caught before viser sees them, in the page and in the stage's frame alike.

const DRIVE = {
  ArrowUp: "up", ArrowDown: "down", ArrowLeft: "left", ArrowRight: "right",
  KeyW: "up", KeyS: "down", KeyA: "left", KeyD: "right",
};
// Widgets that use arrows, space or letters themselves.
const TYPING = "input, textarea, select, [contenteditable='true'], [role='textbox'], [role='combobox'], [role='listbox'], [role='application']";
const ARROWS = "[role='slider'], [role='tab'], [role='radio'], [role='menuitem'], [role='spinbutton'], [role='separator']";
const PRESSING = "button, summary, a[href], [role='button'], [role='tab'], [role='checkbox'], [role='switch']";

export class Keys {
  // `drive(name, down)` for the driving keys, `act(name)` for all others, `allUp()` when keys may have been let go unseen.
  constructor({ drive, act, allUp }) {
    this.calls = { drive, act, allUp };
    this.listen(window);
    document.addEventListener("visibilitychange", () => document.hidden && allUp());
    window.addEventListener("pagehide", allUp);
  }

  listen(target) {
    target.addEventListener("keydown", (event) => this.down(event), true);
    target.addEventListener("keyup", (event) => this.up(event), true);
    // Focus that only moves between the page and its frame is no loss: both are listened to.
    target.addEventListener("blur", () => setTimeout(() => document.hasFocus() || this.calls.allUp()), true);
  }

  down(event) {
    const target = event.target?.closest ? event.target : null;
    const dialog = document.querySelector("dialog[open]");
    if (event.ctrlKey || event.metaKey || event.altKey || event.isComposing || target?.closest(TYPING)) return;
    const drive = DRIVE[event.code];
    if (drive && !dialog) {
      if (event.code.startsWith("Arrow") && target?.closest(ARROWS)) return;
      swallow(event);
      if (!event.repeat) this.calls.drive(drive, true);
      return;
    }
    const name = event.key === "?" || event.key === "Escape" ? event.key : event.key.toLowerCase();
    if (name === " " && target?.closest(PRESSING)) return;
    if (dialog && name !== "?") return;
    if (!event.repeat && this.calls.act(name)) swallow(event);
  }

  up(event) {
    const drive = DRIVE[event.code];
    if (drive) this.calls.drive(drive, false);
  }
}

function swallow(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}

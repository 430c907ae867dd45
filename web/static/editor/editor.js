// The world editor: a plan from above, tools that draw on it, undo and redo. Edits go to the engine as commands. The engine's
// world is the only one, and it is read again after each change.

import { $, within } from "../ui/elements.js";
import { Fields, kindOf } from "./things.js";
import { closeMenu } from "../header/header.js";
import { SaveDialog, WorldClient } from "./world_client.js";
import { Plan } from "./plan.js";
import { Pointer, hintOf, TOOLS } from "./tools.js";
import { nameOfKey } from "../ui/keys.js";
import { away } from "./geometry.js";
import { followingLines } from "./times.js";
import { TimePanel } from "./time_panel.js";

export class Editor {
  /**
   * `open()` and `begin()` ask for another world.
   * @param {import("../net/connection.js").Connection} link to the engine
   * @param {{ open: () => void, begin: () => void }} calls
   */
  constructor(link, { open, begin }) {
    /** @type {Point[]} */
    this.points = []; // of what is being drawn
    /** @type {ToolName} */
    this.tool = "select";
    /** @type {Place | null} */
    this.chosen = null;
    this.box = $("editor");
    this.office = new WorldClient(
      link,
      (other) => this.show(other),
      (text) => this.wrong(text),
    );
    this.plan = new Plan($("plan"));
    this.fields = new Fields(
      $("fields"),
      (item) => this.change(item),
      () => this.remove(this.chosen),
    );
    this.time = new TimePanel(this.office, (text, bad) => this.setStatus(text, bad));
    this.saving = new SaveDialog(this.office);
    this.pointer = new Pointer(this);
    for (const button of this.buttons)
      button.addEventListener("click", () => this.use(/** @type {ToolName} */ (button.dataset.tool)));
    const click = (/** @type {keyof IndexIds} */ id, /** @type {() => void} */ action) =>
      $(id).addEventListener("click", action);
    click("edit", () => this.toggle());
    click("edit-close", () => this.toggle(false));
    click("edit-undo", () => this.undo());
    click("edit-redo", () => this.redo());
    click("edit-fit", () => this.plan.fit());
    click("edit-closer", () => this.plan.zoom(1.4));
    click("edit-farther", () => this.plan.zoom(1 / 1.4));
    click("edit-finish", () => this.finish());
    click("edit-open", open);
    click("edit-new", begin);
    $("edit-menu").addEventListener("click", (event) => within(event, "button, a") && closeMenu($("edit-menu")), true); // first, since a dialog gives the focus back
    click("edit-save", () => this.saving.ask());
    window.addEventListener("keydown", (event) => this.history(event), true);
    this.use("select");
    /** @type {[State, PageFields] | null} */
    this.latest = null; // the newest state of the engine
  }

  /** @returns {NodeListOf<HTMLButtonElement>} */
  get buttons() {
    return this.box.querySelectorAll("button[data-tool]");
  }

  get open() {
    return !this.box.hidden;
  }

  get world() {
    return this.office.world;
  }

  toggle(on = !this.open) {
    this.box.hidden = !on;
    $("edit").setAttribute("aria-pressed", String(on));
    if (!on) return $("edit").focus();
    this.office.load();
    if (this.latest) this.at(...this.latest); // a paused engine says nothing more
    $("plan").focus();
  }

  // ---------------------------------------------------------------- what the engine says

  /** @param {State} state @param {PageFields} page */
  at(state, page) {
    this.latest = /** @type {[State, PageFields]} */ ([state, page]);
    if (!this.open) return;
    const { undo, redo, saved, edition } = page.office ?? {};
    $("edit-undo").disabled = !undo;
    $("edit-redo").disabled = !redo;
    $("edit-undo").title = undo ? `Undo: ${undo} (Ctrl+Z)` : "Nothing to undo";
    $("edit-redo").title = redo ? `Redo: ${redo} (Ctrl+Shift+Z)` : "Nothing to redo";
    $("edit-unsaved").hidden = saved !== false;
    this.plan.showLive({ doors: state.living?.doors, lamps: state.living?.lamps, ...page.moving });
    this.plan.drawRobot(state.robot);
    this.time.at(state.time_s, state.living?.daylight ?? 1);
    if (page.office && edition !== this.office.edition) this.office.load();
    else $("edit-name").textContent = page.title; // that of the plan that is shown, on which keys now draw
  }

  /** @param {boolean} other */
  show(other) {
    if (other) this.choose(null);
    if (!this.world) return;
    this.plan.show(this.world);
    this.time.show(this.world);
    this.choose(this.chosen);
  }

  async undo() {
    this.cancel();
    if (await this.office.undo()) this.say();
  }

  async redo() {
    this.cancel();
    if (await this.office.redo()) this.say();
  }

  /** @param {KeyboardEvent} event */
  history(event) {
    if (!this.open || !(event.ctrlKey || event.metaKey) || event.altKey || document.querySelector("dialog[open]"))
      return;
    if (within(event, "input:not([type=checkbox]), textarea")) return;
    const key = nameOfKey({
      code: event.code,
      key: event.key,
      ctrlKey: false,
      metaKey: false,
      altKey: false,
      isComposing: false,
    });
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) this.redo();
    else this.undo();
  }

  // ---------------------------------------------------------------- what is said

  get hint() {
    return hintOf(this.tool, this.points.length);
  }

  say() {
    const { takes, least = 1 } = TOOLS[this.tool];
    this.setStatus(this.hint + (this.points.length ? " Escape cancels." : ""), false);
    $("edit-finish").hidden = takes !== Infinity || this.points.length < least;
  }

  /** @param {string} text */
  wrong(text) {
    this.setStatus(text, true);
  }

  /** @param {string} text @param {boolean} bad */
  setStatus(text, bad) {
    const line = $("plan-status");
    if (line.textContent !== text) line.textContent = text;
    line.classList.toggle("bad", bad);
  }

  // ---------------------------------------------------------------- tools

  /** @param {ToolName} tool */
  use(tool) {
    this.tool = tool;
    this.cancel();
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.tool === tool));
    $("wall-options").hidden = tool !== "wall";
    $("plan").dataset.tool = tool;
    if (tool !== "select") this.choose(null);
    this.say();
  }

  cancel() {
    this.points = [];
    this.plan.draft([], this.tool);
    this.say();
  }

  escape() {
    if (this.points.length) this.cancel();
    else if (this.chosen) this.choose(null);
    else if (this.tool !== "select") this.use("select");
    else this.toggle(false);
  }

  /** One more point of what is being drawn. @param {Point} p */
  press(p) {
    const { takes, chain } = TOOLS[this.tool];
    const last = this.points[this.points.length - 1];
    if (last && away(last, p) < 1e-3) return takes === Infinity ? this.finish() : undefined;
    this.points.push(p);
    this.say();
    if (this.points.length === takes) this.make(chain ? [p] : []);
    else this.plan.draft(this.points, this.tool);
  }

  /** The end of a stroke that was dragged from the first point to the second. @param {Point} p */
  pressSecond(p) {
    const { takes, chain } = TOOLS[this.tool];
    if (!this.points.length || takes !== 2) return;
    this.press(p);
    if (chain) this.points = [];
  }

  /** Shows what would be drawn if the next point were here. @param {Point} p */
  draftTo(p) {
    this.plan.draft([...this.points, p], this.tool);
  }

  finish() {
    const { takes, least = 1 } = TOOLS[this.tool];
    if (takes === Infinity && this.points.length >= least) this.make([]);
    else this.cancel();
  }

  /** @param {Point[]} rest the points that the next one begins with */
  async make(rest) {
    const { list, makes, chain } = TOOLS[this.tool];
    if (!list || !makes) return;
    const kind = /** @type {Wall["kind"]} */ ($("wall-kind").value);
    const [points, looks] = [this.points, { kind, height: Number($("wall-height").value) }];
    this.points = rest;
    const done = await this.office.edit((world) => makes(points, world, looks));
    if (!done) {
      if (this.points === rest) this.points = [];
      this.plan.draft(this.points, this.tool);
      $("edit-finish").hidden = true;
      return;
    }
    this.plan.draft(this.points, this.tool);
    this.say();
    if (!chain) this.choose({ list, number: (this.world?.[list]?.length ?? 0) - 1 });
  }

  // ---------------------------------------------------------------- what is selected

  /** @param {Place | null} chosen */
  choose(chosen) {
    const item = chosen && this.world?.[chosen.list]?.[chosen.number];
    this.chosen = item ? { list: chosen.list, number: chosen.number } : null;
    this.plan.choose(item ? { list: chosen.list, item } : null);
    this.fields.show(this.chosen && { ...this.chosen, item });
  }

  /** @param {any} item */
  change(item) {
    if (!this.chosen) return;
    const { list, number } = this.chosen;
    this.office.edit((world) => {
      const name = world[list]?.[number].name ?? "";
      const lines = item.name === undefined || item.name === name ? [] : followingLines(world, list, name, item.name);
      return [...lines, { do: "change", list, number, item }];
    });
  }

  /** @param {Place | null} thing */
  async remove(thing) {
    if (!thing) return;
    const { list, number } = thing;
    const { one } = kindOf(list);
    /** @type {EditStep[]} */
    let lines = [];
    const makes = (/** @type {World} */ world) => {
      lines = followingLines(world, list, world[list]?.[number].name ?? "", null);
      return [...lines, /** @type {EditStep} */ ({ do: "delete", list, number })];
    };
    if (await this.office.edit(makes)) {
      this.choose(null);
      const also = lines.length ? ` and ${lines.length} line${lines.length > 1 ? "s" : ""} of the script` : "";
      this.setStatus(`${one[0].toUpperCase()}${one.slice(1)}${also} deleted. Ctrl+Z brings it back.`, false);
    }
  }
}

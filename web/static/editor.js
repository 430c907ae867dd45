// The world editor: a plan from above, tools that draw on it, undo and redo. What is drawn goes to the engine as commands;
// the engine's world is the only one, and is read again after each change.

import { Fields } from "./fields.js";
import { closeMenu } from "./menus.js";
import { Office } from "./office.js";
import { Plan } from "./plan.js";
import { Pointer } from "./pointer.js";
import { SaveDialog } from "./save_dialog.js";
import { followingLines } from "./script.js";
import { THINGS, at, away, pulledEnds } from "./things.js";
import { TimePanel } from "./time_panel.js";
import { TOOLS } from "./tools.js";

const $ = (id) => document.getElementById(id);

export class Editor {
  // `link`: to the engine; `open()` and `begin()` ask for another world.
  constructor(link, { open, begin }) {
    Object.assign(this, { points: [], tool: "select", chosen: null });
    this.box = $("editor");
    this.office = new Office(link, (other) => this.show(other), (text) => this.wrong(text));
    this.plan = new Plan($("plan"));
    this.fields = new Fields($("fields"), (item) => this.change(item), () => this.remove(this.chosen));
    this.time = new TimePanel(this.office, (text, bad) => this.tell(text, bad));
    this.saving = new SaveDialog(this.office);
    this.pointer = new Pointer(this);
    for (const button of this.box.querySelectorAll("button[data-tool]")) button.addEventListener("click", () => this.use(button.dataset.tool));
    const click = (id, action) => $(id).addEventListener("click", action);
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
    $("edit-menu").addEventListener("click", ({ target }) => target.closest("button, a") && closeMenu($("edit-menu")), true); // first: a dialog gives the focus back
    click("edit-save", () => this.saving.ask());
    window.addEventListener("keydown", (event) => this.history(event), true);
    this.use("select");
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
    $("plan").focus();
  }

  // ---------------------------------------------------------------- what the engine says

  at(state, page) {
    if (!this.open) return;
    const { undo, redo, saved, edition } = page.office ?? {};
    $("edit-undo").disabled = !undo;
    $("edit-redo").disabled = !redo;
    $("edit-undo").title = undo ? `Undo: ${undo} (Ctrl+Z)` : "Nothing to undo";
    $("edit-redo").title = redo ? `Redo: ${redo} (Ctrl+Shift+Z)` : "Nothing to redo";
    $("edit-name").textContent = page.title;
    $("edit-unsaved").hidden = saved !== false;
    this.plan.showLive({ doors: state.living?.doors, lamps: state.living?.lamps, ...page.moving });
    this.plan.drawRobot(state.robot);
    this.time.at(state.time_s, state.living?.daylight ?? 1);
    if (page.office && edition !== this.office.edition) this.office.load();
  }

  show(other) {
    if (other) this.choose(null);
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

  history(event) {
    if (!this.open || !(event.ctrlKey || event.metaKey) || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.target.closest?.("input:not([type=checkbox]), textarea")) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) this.redo();
    else this.undo();
  }

  // ---------------------------------------------------------------- what is said

  get hint() {
    const { says } = TOOLS[this.tool];
    return says[Math.min(this.points.length, says.length - 1)];
  }

  say() {
    const { takes, least = 1 } = TOOLS[this.tool];
    this.tell(this.hint + (this.points.length ? " Escape cancels." : ""), false);
    $("edit-finish").hidden = takes !== Infinity || this.points.length < least;
  }

  wrong(text) {
    this.tell(text, true);
  }

  tell(text, bad) {
    const line = $("plan-status");
    if (line.textContent !== text) line.textContent = text;
    line.classList.toggle("bad", bad);
  }

  // ---------------------------------------------------------------- tools

  use(tool) {
    this.tool = tool;
    this.cancel();
    for (const button of this.box.querySelectorAll("button[data-tool]")) button.setAttribute("aria-pressed", String(button.dataset.tool === tool));
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

  // One more point of what is being drawn.
  press(p) {
    const { takes, chain } = TOOLS[this.tool];
    const last = this.points[this.points.length - 1];
    if (last && away(last, p) < 1e-3) return takes === Infinity ? this.finish() : undefined;
    this.points.push(p);
    this.say();
    if (this.points.length === takes) this.make(chain ? [p] : []);
    else this.plan.draft(this.points, this.tool);
  }

  finish() {
    const { takes, least } = TOOLS[this.tool];
    if (takes === Infinity && this.points.length >= least) this.make([]);
    else this.cancel();
  }

  async make(rest) {
    const { list, makes, chain } = TOOLS[this.tool];
    const [points, options] = [this.points, { kind: $("wall-kind").value, height: Number($("wall-height").value) }];
    this.points = rest;
    const done = await this.office.edit(() => makes(points, this.world, options));
    if (!done) {
      if (this.points === rest) this.points = [];
      this.plan.draft(this.points, this.tool);
      $("edit-finish").hidden = true;
      return;
    }
    this.plan.draft(this.points, this.tool);
    this.say();
    if (!chain) this.choose({ list, number: this.world[list].length - 1 });
  }

  // ---------------------------------------------------------------- what is selected

  choose(chosen) {
    const item = chosen && this.world?.[chosen.list]?.[chosen.number];
    this.chosen = item ? { list: chosen.list, number: chosen.number } : null;
    this.plan.choose(item ? { list: chosen.list, item } : null);
    this.fields.show(this.chosen && { ...this.chosen, item });
  }

  change(item) {
    const { list, number } = this.chosen;
    return this.office.edit(() => {
      const before = this.world[list][number];
      const lines = item.name === before.name ? [] : followingLines(this.world, list, before.name, item.name);
      return [...lines, { do: "change", list, number, item }];
    });
  }

  async remove(thing) {
    if (!thing) return;
    const { list, number } = thing;
    const { one } = THINGS[list];
    let lines = [];
    const makes = () => {
      lines = followingLines(this.world, list, this.world[list][number].name, null);
      return [...lines, { do: "delete", list, number }];
    };
    if (await this.office.edit(makes)) {
      this.choose(null);
      const also = lines.length ? ` and ${lines.length} line${lines.length > 1 ? "s" : ""} of the script` : "";
      this.tell(`${one[0].toUpperCase()}${one.slice(1)}${also} deleted. Ctrl+Z brings it back.`, false);
    }
  }

  // Where a thing goes when a grip, or all of it, is pulled from one point to another: the item, and the steps.
  moved({ list, number, grip, item }, from, to) {
    const { shift, pull, grips } = THINGS[list];
    const d = [to[0] - from[0], to[1] - from[1]];
    const now = grip === null ? shift(item, d) : pull(item, grip, at(grips(item)[grip][0] + d[0], grips(item)[grip][1] + d[1]));
    const steps = [{ do: "change", list, number, item: now }];
    if (list !== "walls" || (grip === null && !item.outer)) return { now, steps };
    const moves = grip === null ? [[item.from, now.from], [item.to, now.to]] : [[grips(item)[grip], grips(now)[grip]]];
    return { now, steps: [...steps, ...pulledEnds(this.world, moves, [number])] };
  }
}

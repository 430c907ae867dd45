// The world editor: a plan from above, tools that draw on it, undo and redo. What is drawn goes to the engine as commands;
// the engine's world is the only one, and is read again after each change.

import { Plan } from "./plan.js";
import { Fields } from "./fields.js";
import { sentence } from "./files.js";
import { THINGS, at, away, pulledEnds } from "./things.js";
import { toast } from "./toasts.js";
import { TOOLS } from "./tools.js";

const $ = (id) => document.getElementById(id);
const DRAG_PX = 6;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Editor {
  // `link`: to the engine; `files`: opens worlds.
  constructor(link, files) {
    Object.assign(this, { link, files, points: [], tool: "select", chosen: null, office: null, world: null, pressed: null });
    this.box = $("editor");
    this.plan = new Plan($("plan"));
    this.fields = new Fields($("fields"), (item) => this.change(item), () => this.remove(this.chosen));
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
    click("edit-open", () => files.open());
    click("edit-save", () => this.askName());
    $("grid").addEventListener("change", () => this.useGrid());
    $("snap").addEventListener("change", () => this.useGrid());
    $("save-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.save();
    });
    click("save-close", () => $("save-dialog").close());
    this.listen($("plan"));
    window.addEventListener("keydown", (event) => this.history(event), true);
    this.useGrid();
    this.use("select");
  }

  get open() {
    return !this.box.hidden;
  }

  toggle(on = !this.open) {
    this.box.hidden = !on;
    $("edit").setAttribute("aria-pressed", String(on));
    if (!on) return $("edit").focus();
    this.load();
    $("plan").focus();
  }

  // ---------------------------------------------------------------- what the engine says

  at(state, page) {
    this.office = page.office;
    if (!this.open) return;
    $("edit-undo").disabled = !this.office?.undo;
    $("edit-redo").disabled = !this.office?.redo;
    $("edit-undo").title = this.office?.undo ? `Undo: ${this.office.undo} (Ctrl+Z)` : "Nothing to undo";
    $("edit-redo").title = this.office?.redo ? `Redo: ${this.office.redo} (Ctrl+Shift+Z)` : "Nothing to redo";
    $("edit-name").textContent = page.title;
    $("edit-unsaved").hidden = this.office?.saved !== false;
    this.plan.showDoors(state.living?.doors);
    this.plan.drawRobot(state.robot);
    if (this.office && this.office.edition !== this.seen) this.load();
  }

  // The world as it is now. What arrives while another answer is under way is asked for once more.
  async load() {
    if (this.loading) {
      this.again = true;
      return this.loading;
    }
    this.loading = this.fetch();
    await this.loading;
    this.loading = null;
    if (this.again) {
      this.again = false;
      await this.load();
    }
  }

  async fetch() {
    try {
      const told = await (await fetch("/api/world")).json();
      if (!told.world) return;
      const other = this.world?.name !== told.world.name;
      Object.assign(this, { world: told.world, seen: told.edition, ours: told.ours, yours: told.yours });
      if (other) this.choose(null);
      this.plan.show(this.world);
      const still = this.chosen && this.world[this.chosen.list]?.[this.chosen.number];
      this.choose(still ? this.chosen : null);
    } catch {
      // the connection is lost, which the page says; it is read again with the next state
      this.seen = null;
    }
  }

  // One edit. Resolves to whether it was done; what was wrong stands in the status line until the next step.
  async send(command) {
    const before = this.busy;
    this.busy = (async () => {
      await before; // edits that follow each other quickly are made on what the one before left
      const wish = command();
      if (!wish) return false;
      const answer = await this.link.ask(wish, { quiet: true });
      if (answer.accepted) await this.load();
      else this.wrong(answer.detail.map((wrong) => sentence(wrong.reason.replace(/^steps\[\d+\]: /, ""))).join(" ") || "The connection is lost; nothing was changed.");
      return answer.accepted;
    })();
    return this.busy;
  }

  edit(makes) {
    return this.send(() => {
      const steps = makes();
      if (typeof steps === "string") this.wrong(steps);
      return typeof steps === "string" || !steps.length ? null : { type: "edit_world", steps, edition: this.seen };
    });
  }

  async undo() {
    this.cancel();
    if (await this.send(() => ({ type: "undo_edit" }))) this.say();
  }

  async redo() {
    this.cancel();
    if (await this.send(() => ({ type: "redo_edit" }))) this.say();
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

  say() {
    const { says, takes, least = 1 } = TOOLS[this.tool];
    const hint = says[Math.min(this.points.length, says.length - 1)];
    const escape = this.points.length ? " Escape cancels." : "";
    this.tell(hint + escape, false);
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
    const done = await this.edit(() => makes(points, this.world, options));
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

  choose(chosen) {
    const item = chosen && this.world?.[chosen.list]?.[chosen.number];
    this.chosen = item ? { list: chosen.list, number: chosen.number } : null;
    this.plan.choose(item ? { list: chosen.list, item } : null);
    this.fields.show(this.chosen && { ...this.chosen, item });
  }

  change(item) {
    const { list, number } = this.chosen;
    return this.edit(() => [{ do: "change", list, number, item }]);
  }

  async remove(thing) {
    if (!thing) return;
    const { one } = THINGS[thing.list];
    if (await this.edit(() => [{ do: "delete", list: thing.list, number: thing.number }])) {
      this.choose(null);
      this.tell(`${one[0].toUpperCase()}${one.slice(1)} deleted. Ctrl+Z brings it back.`, false);
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

  // ---------------------------------------------------------------- pointer and keys

  useGrid() {
    this.grid = Number($("grid").value);
    this.snaps = $("snap").checked;
    this.plan.grid = this.grid;
    this.plan.draw();
  }

  snapped(p, free) {
    if (free || !this.snaps) return at(...p);
    const end = TOOLS[this.tool].list === "walls" || this.pressed?.list === "walls" ? this.plan.endNear(p) : null;
    return end ?? at(...p.map((u) => Math.round(u / this.grid) * this.grid));
  }

  where(event) {
    const box = $("plan").getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  listen(plan) {
    plan.addEventListener("pointerdown", (event) => this.down(event));
    plan.addEventListener("pointermove", (event) => this.move(event));
    plan.addEventListener("pointerup", (event) => this.up(event));
    plan.addEventListener("pointercancel", () => this.letGo());
    plan.addEventListener("dblclick", () => this.finish());
    plan.addEventListener("contextmenu", (event) => event.preventDefault());
    plan.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.plan.zoom(Math.exp(-event.deltaY * 0.0016), this.where(event));
    }, { passive: false });
    plan.addEventListener("keydown", (event) => this.key(event));
    plan.addEventListener("blur", () => this.plan.cursor(null));
  }

  down(event) {
    if (!this.world) return;
    $("plan").setPointerCapture(event.pointerId);
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    this.plan.cursor(null);
    if (event.button > 0) this.pressed = { pixel, pans: true };
    else if (this.tool === "select") this.grab(pixel, p, event.altKey);
    else if (this.tool === "delete") this.pressed = { pixel };
    else {
      this.press(this.snapped(p, event.altKey));
      this.pressed = { pixel };
    }
  }

  grab(pixel, p, free) {
    const chosen = this.chosen && { ...this.chosen, item: this.world[this.chosen.list][this.chosen.number] };
    const grip = chosen ? this.plan.gripAt(chosen.item, chosen.list, p) : null;
    const thing = grip === null ? this.plan.thingAt(p) : chosen;
    this.choose(thing);
    const from = this.snapped(p, free);
    if (thing) this.pressed = { pixel, from, ...thing, grip, item: this.world[thing.list][thing.number] };
    else this.pressed = { pixel, pans: true };
  }

  move(event) {
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    const held = this.pressed;
    if (held?.pans) {
      this.plan.pan(pixel[0] - held.pixel[0], pixel[1] - held.pixel[1]);
      held.pixel = pixel;
    } else if (held?.item) {
      if (!held.moves && away(pixel, held.pixel) < DRAG_PX) return;
      held.moves = true;
      held.to = this.snapped(p, event.altKey);
      this.plan.choose({ list: held.list, item: this.moved(held, held.from, held.to).now });
    } else if (TOOLS[this.tool].takes) this.plan.draft([...this.points, this.snapped(p, event.altKey)], this.tool);
  }

  async up(event) {
    const held = this.pressed;
    this.pressed = null;
    if (!held || held.pans) return;
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    if (this.tool === "delete") {
      const thing = this.plan.thingAt(p);
      if (thing) this.remove(thing);
      else this.wrong("There is nothing to delete here.");
    } else if (held.item) {
      if (!held.moves || away(held.from, held.to) < 1e-9) return this.choose(this.chosen);
      const done = await this.edit(() => this.moved(held, held.from, held.to).steps);
      this.choose(this.chosen);
      if (done) this.say();
    } else if (this.points.length && away(pixel, held.pixel) > DRAG_PX && TOOLS[this.tool].takes === 2) {
      this.press(this.snapped(p, event.altKey)); // pulled from the first point to the second
      if (TOOLS[this.tool].chain) this.points = [];
    }
  }

  letGo() {
    this.pressed = null;
    this.choose(this.chosen);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || !this.world) return;
    const step = ARROWS[event.key];
    const tool = Object.keys(TOOLS).find((name) => TOOLS[name].key === event.key.toLowerCase());
    if (step) this.step(step, event.shiftKey ? 5 : 1);
    else if (event.key === "Enter" || event.key === " ") this.enter();
    else if (event.key === "Escape") this.escape();
    else if (event.key === "Delete" || event.key === "Backspace") this.remove(this.chosen);
    else if (event.key === "+" || event.key === "-") this.plan.zoom(event.key === "+" ? 1.4 : 1 / 1.4);
    else if (event.key === "0") this.plan.fit();
    else if (event.key === "o") this.toggle(false);
    else if (tool && !event.altKey) this.use(tool);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  // The cross that the arrow keys move: it begins in the middle of what is seen.
  get cross() {
    const { clientWidth, clientHeight } = $("plan");
    return this.plan.crosshair ?? this.snapped(this.plan.metres([clientWidth / 2, clientHeight / 2]), false);
  }

  step([dx, dy], times) {
    const p = at(this.cross[0] + dx * times * this.grid, this.cross[1] + dy * times * this.grid);
    this.plan.cursor(p);
    this.plan.reveal(p);
    if (this.points.length) this.plan.draft([...this.points, p], this.tool);
    this.tell(`${p[0].toFixed(2)}, ${p[1].toFixed(2)} m. ${TOOLS[this.tool].says[Math.min(this.points.length, TOOLS[this.tool].says.length - 1)]}`, false);
  }

  enter() {
    const p = this.cross;
    this.plan.cursor(p);
    if (this.tool === "select") {
      this.choose(this.plan.thingAt(p));
      this.tell(this.chosen ? `${THINGS[this.chosen.list].one} selected. Delete removes it; its values are in the form.` : "There is nothing here.", false);
    } else if (this.tool === "delete") this.remove(this.plan.thingAt(p));
    else this.press(p);
  }

  escape() {
    if (this.points.length) this.cancel();
    else if (this.chosen) this.choose(null);
    else if (this.tool !== "select") this.use("select");
    else this.toggle(false);
  }

  // ---------------------------------------------------------------- saving

  askName() {
    if (!this.world) return;
    const ours = this.world.name in this.ours;
    $("save-name").value = ours ? `my-${this.world.name}` : this.world.name;
    $("save-title").value = this.world.title;
    $("save-wrong").hidden = true;
    $("save-replace-row").hidden = true;
    $("save-replace").checked = false;
    $("save-dialog").showModal();
    $("save-name").select();
  }

  async save() {
    const body = { name: $("save-name").value.trim(), title: $("save-title").value.trim() || null, replace: $("save-replace").checked };
    let told;
    try {
      const answer = await fetch("/api/worlds/save", {
        method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body),
      });
      told = await answer.json();
    } catch {
      told = { detail: [{ reason: "the connection is lost; nothing was saved" }] };
    }
    if (told.file) {
      $("save-dialog").close();
      toast(`Saved as ${told.file}`);
      return;
    }
    $("save-wrong").textContent = told.detail.map((wrong) => sentence(wrong.reason)).join(" ");
    $("save-wrong").hidden = false;
    $("save-replace-row").hidden = told.detail[0].field !== "replace";
  }
}

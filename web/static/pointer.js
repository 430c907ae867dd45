// What pointer and keys do on the editor's plan.

import { THINGS, at, away } from "./things.js";
import { TOOLS } from "./tools.js";

const $ = (id) => document.getElementById(id);
const DRAG_PX = 6;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Pointer {
  constructor(editor) {
    Object.assign(this, { editor, plan: editor.plan, pressed: null });
    $("grid").addEventListener("change", () => this.useGrid());
    $("snap").addEventListener("change", () => this.useGrid());
    this.useGrid();
    const place = $("plan");
    place.addEventListener("pointerdown", (event) => this.down(event));
    place.addEventListener("pointermove", (event) => this.move(event));
    place.addEventListener("pointerup", (event) => this.up(event));
    place.addEventListener("pointercancel", () => this.letGo());
    place.addEventListener("dblclick", () => editor.finish());
    place.addEventListener("contextmenu", (event) => event.preventDefault());
    place.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.plan.zoom(Math.exp(-event.deltaY * 0.0016), this.where(event));
    }, { passive: false });
    place.addEventListener("keydown", (event) => this.key(event));
    place.addEventListener("blur", () => this.plan.cursor(null));
  }

  useGrid() {
    this.grid = Number($("grid").value);
    this.snaps = $("snap").checked;
    this.plan.grid = this.grid;
    this.plan.draw();
  }

  snapped(p, free) {
    if (free || !this.snaps) return at(...p);
    const end = TOOLS[this.editor.tool].list === "walls" || this.pressed?.list === "walls" ? this.plan.endNear(p) : null;
    return end ?? at(...p.map((u) => Math.round(u / this.grid) * this.grid));
  }

  where(event) {
    const box = $("plan").getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // ---------------------------------------------------------------- pointer

  down(event) {
    const { editor } = this;
    if (!editor.world) return;
    $("plan").setPointerCapture(event.pointerId);
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    this.plan.cursor(null);
    if (event.button > 0) this.pressed = { pixel, pans: true };
    else if (editor.tool === "select") this.grab(pixel, p, event.altKey);
    else if (editor.tool === "delete") this.pressed = { pixel };
    else {
      editor.press(this.snapped(p, event.altKey));
      this.pressed = { pixel };
    }
  }

  grab(pixel, p, free) {
    const { chosen: before, world } = this.editor;
    const chosen = before && { ...before, item: world[before.list][before.number] };
    const grip = chosen ? this.plan.gripAt(chosen.item, chosen.list, p) : null;
    const thing = grip === null ? this.plan.thingAt(p) : chosen;
    this.editor.choose(thing);
    const from = this.snapped(p, free);
    if (thing) this.pressed = { pixel, from, ...thing, grip, item: world[thing.list][thing.number] };
    else this.pressed = { pixel, pans: true };
  }

  move(event) {
    const { editor, pressed: held } = this;
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    if (held?.pans) {
      this.plan.pan(pixel[0] - held.pixel[0], pixel[1] - held.pixel[1]);
      held.pixel = pixel;
    } else if (held?.item) {
      if (!held.moves && away(pixel, held.pixel) < DRAG_PX) return;
      held.moves = true;
      held.to = this.snapped(p, event.altKey);
      this.plan.choose({ list: held.list, item: editor.moved(held, held.from, held.to).now });
    } else if (TOOLS[editor.tool].takes) this.plan.draft([...editor.points, this.snapped(p, event.altKey)], editor.tool);
  }

  async up(event) {
    const { editor, pressed: held } = this;
    this.pressed = null;
    if (!held || held.pans) return;
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    if (editor.tool === "delete") {
      const thing = this.plan.thingAt(p);
      if (thing) editor.remove(thing);
      else editor.wrong("There is nothing to delete here.");
    } else if (held.item) {
      if (!held.moves || away(held.from, held.to) < 1e-9) return editor.choose(editor.chosen);
      const done = await editor.office.edit(() => editor.moved(held, held.from, held.to).steps);
      editor.choose(editor.chosen);
      if (done) editor.say();
    } else if (editor.points.length && away(pixel, held.pixel) > DRAG_PX && TOOLS[editor.tool].takes === 2) {
      editor.press(this.snapped(p, event.altKey)); // pulled from the first point to the second
      if (TOOLS[editor.tool].chain) editor.points = [];
    }
  }

  letGo() {
    this.pressed = null;
    this.editor.choose(this.editor.chosen);
  }

  // ---------------------------------------------------------------- keys

  key(event) {
    const { editor } = this;
    if (event.ctrlKey || event.metaKey || !editor.world) return;
    const step = ARROWS[event.key];
    const tool = Object.keys(TOOLS).find((name) => TOOLS[name].key === event.key.toLowerCase());
    if (step) this.step(step, event.shiftKey ? 5 : 1);
    else if (event.key === "Enter" || event.key === " ") this.enter();
    else if (event.key === "Escape") editor.escape();
    else if (event.key === "Delete" || event.key === "Backspace") editor.remove(editor.chosen);
    else if (event.key === "+" || event.key === "-") this.plan.zoom(event.key === "+" ? 1.4 : 1 / 1.4);
    else if (event.key === "0") this.plan.fit();
    else if (event.key === "o") editor.toggle(false);
    else if (event.key === "c") editor.time.toggle();
    else if (tool && !event.altKey) editor.use(tool);
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
    const { editor } = this;
    const p = at(this.cross[0] + dx * times * this.grid, this.cross[1] + dy * times * this.grid);
    this.plan.cursor(p);
    this.plan.reveal(p);
    if (editor.points.length) this.plan.draft([...editor.points, p], editor.tool);
    editor.tell(`${p[0].toFixed(2)}, ${p[1].toFixed(2)} m. ${editor.hint}`, false);
  }

  enter() {
    const { editor } = this;
    const p = this.cross;
    this.plan.cursor(p);
    if (editor.tool === "select") {
      editor.choose(this.plan.thingAt(p));
      editor.tell(editor.chosen ? `${THINGS[editor.chosen.list].one} selected. Delete removes it; its values are in the form.` : "There is nothing here.", false);
    } else if (editor.tool === "delete") editor.remove(this.plan.thingAt(p));
    else editor.press(p);
  }
}

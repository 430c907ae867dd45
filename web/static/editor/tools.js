// The drawing tools (how many points each takes, what to click next, and what the points make), and what the pointer and the keys do
// with them on the editor's plan.

import { LIMITS } from "../shared.js";
import { at, away, degrees, round } from "./geometry.js";
import { newName, moved, THINGS } from "./things.js";
import { gapSteps } from "./walls.js";
import { $ } from "../ui/elements.js";

/** @param {ThingList} list @param {object} item @returns {EditStep[]} */
const adds = (list, item) => [{ do: "add", list, item }];

/**
 * `takes`: how many points; Infinity: until Enter, with at least `least`. `says`: what to click next, by the number of points.
 * `makes(points, world, looks)`: the steps of one edit, or a sentence that says why there are none.
 * @type {Record<ToolName, Tool>}
 */
export const TOOLS = {
  select: {
    title: "Select",
    key: "v",
    says: ["Click a thing to select it, drag it to move it; drag the floor to move the plan."],
  },
  wall: {
    title: "Wall",
    key: "w",
    takes: 2,
    chain: true,
    list: "walls",
    says: ["Click where the wall begins.", "Click where it ends."],
    makes: ([from, to], _world, { kind, height }) => adds("walls", { from, to, kind, height }),
  },
  door: {
    title: "Door",
    key: "d",
    takes: 2,
    list: "doors",
    says: ["Click the hinge; on an inner wall the door makes its own gap.", "Click how far the shut leaf reaches."],
    makes([hinge, to], world) {
      const width = round(away(hinge, to));
      const [least, most] = LIMITS.doors.width;
      if (width < least || width > most) return `A door is ${least} to ${most} m wide; this one would be ${width} m.`;
      const item = { name: newName(world, "doors"), hinge, angle_deg: degrees(hinge, to), width };
      return [...gapSteps(world, hinge, to), ...adds("doors", item)];
    },
  },
  lamp: {
    title: "Lamp",
    key: "l",
    takes: 1,
    list: "lamps",
    says: ["Click where the lamp hangs."],
    makes: ([[x, y]], world) =>
      adds("lamps", { name: newName(world, "lamps"), x, y, reach: 4, brightness: 0.5, on: true }),
  },
  box: {
    title: "Box",
    key: "b",
    takes: 2,
    list: "boxes",
    says: ["Click a corner of the box.", "Click the corner opposite."],
    makes([a, b], world) {
      const [width, depth] = [round(Math.abs(a[0] - b[0])), round(Math.abs(a[1] - b[1]))];
      const [least] = LIMITS.boxes.width;
      if (Math.min(width, depth) < least)
        return `A box is at least ${least} m each way; this one would be ${width} × ${depth} m.`;
      const [x, y] = at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
      return adds("boxes", { name: newName(world, "boxes"), x, y, width, depth });
    },
  },
  person: {
    title: "Person",
    key: "p",
    takes: Infinity,
    least: 1,
    list: "people",
    says: [
      "Click the first point of the path.",
      "Click the next point, or finish: somebody who stands there.",
      "Click the next point, or finish.",
    ],
    makes: (path, world) => adds("people", { name: newName(world, "people"), path, loop: path.length > 2 }),
  },
  zone: {
    title: "Slow zone",
    key: "z",
    takes: Infinity,
    least: 3,
    list: "slow_zones",
    says: [
      "Click a corner of the slow floor.",
      "Click the next corner.",
      "Click the next corner.",
      "Click the next corner, or finish.",
    ],
    makes: (corners, world) => adds("slow_zones", { name: newName(world, "slow_zones"), corners, factor: 0.5 }),
  },
  start: {
    title: "Start",
    key: "s",
    takes: 2,
    list: "starts",
    says: ["Click where a robot may start; the first of all starts is used.", "Click where it looks to."],
    makes: ([from, to], world) =>
      adds("starts", { name: newName(world, "starts"), x: from[0], y: from[1], heading_deg: degrees(from, to) }),
  },
  place: {
    title: "Place",
    key: "n",
    takes: 1,
    list: "places",
    says: ["Click the place; give it a name afterwards."],
    makes: ([[x, y]], world) => adds("places", { name: newName(world, "places"), x, y }),
  },
  delete: { title: "Delete", key: "x", says: ["Click what is to go."] },
};

/** What to click next. @param {ToolName} tool @param {number} points how many there are */
export const hintOf = (tool, points) => TOOLS[tool].says[Math.min(points, TOOLS[tool].says.length - 1)];

/** The tool of a key. @param {string} key */
export const toolOf = (key) => names.find((name) => TOOLS[name].key === key.toLowerCase());

const names = /** @type {ToolName[]} */ (Object.keys(TOOLS));

const DRAG_PX = 6;
/** @type {Record<string, Point>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * What the pointer holds: the plan that it moves, a thing that it drags, or only the place where it was pressed.
 * @typedef {{ kind: "plan" | "press", pixel: Point }} Press
 * @typedef {{ kind: "thing", pixel: Point, from: Point, to: Point, moves: boolean, grip: number | null, item: any } & Place} Pull
 */

export class Pointer {
  /** @param {import("./editor.js").Editor} editor */
  constructor(editor) {
    this.editor = editor;
    this.plan = editor.plan;
    /** @type {Press | Pull | null} */
    this.pressed = null;
    this.grid = 0;
    this.snaps = true;
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
    place.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.plan.zoom(Math.exp(-event.deltaY * 0.0016), this.where(event));
      },
      { passive: false },
    );
    place.addEventListener("keydown", (event) => this.key(event));
    place.addEventListener("blur", () => this.plan.cursor(null));
  }

  useGrid() {
    this.grid = Number($("grid").value);
    this.snaps = $("snap").checked;
    this.plan.grid = this.grid;
    this.plan.draw();
  }

  /** @param {Point} p @param {boolean} free @returns {Point} */
  snapped(p, free) {
    if (free || !this.snaps) return at(...p);
    const pulled = this.pressed?.kind === "thing" ? this.pressed.list : null;
    const end = TOOLS[this.editor.tool].list === "walls" || pulled === "walls" ? this.plan.endNear(p) : null;
    return end ?? at(Math.round(p[0] / this.grid) * this.grid, Math.round(p[1] / this.grid) * this.grid);
  }

  /** @param {MouseEvent} event @returns {Point} */
  where(event) {
    const box = $("plan").getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // ---------------------------------------------------------------- pointer

  /** @param {PointerEvent} event */
  down(event) {
    const { editor } = this;
    if (!editor.world) return;
    $("plan").setPointerCapture(event.pointerId);
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    this.plan.cursor(null);
    if (event.button > 0) this.pressed = { kind: "plan", pixel };
    else if (editor.tool === "select") this.pressed = this.grab(editor.world, pixel, p, event.altKey);
    else {
      if (editor.tool !== "delete") editor.press(this.snapped(p, event.altKey));
      this.pressed = { kind: "press", pixel };
    }
  }

  /** @param {World} world @param {Point} pixel @param {Point} p @param {boolean} free @returns {Press | Pull} */
  grab(world, pixel, p, free) {
    const before = this.editor.chosen;
    const grip = before ? this.plan.gripAt(itemOf(world, before), before.list, p) : null;
    const thing = grip === null ? this.plan.thingAt(p) : before;
    this.editor.choose(thing);
    const from = this.snapped(p, free);
    if (!thing) return { kind: "plan", pixel };
    return { kind: "thing", pixel, from, to: from, moves: false, ...thing, grip, item: itemOf(world, thing) };
  }

  /** @param {PointerEvent} event */
  move(event) {
    const { editor, pressed: held } = this;
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    if (held?.kind === "plan") {
      this.plan.pan(pixel[0] - held.pixel[0], pixel[1] - held.pixel[1]);
      held.pixel = pixel;
    } else if (held?.kind === "thing") this.pull(held, pixel, this.snapped(p, event.altKey));
    else if (TOOLS[editor.tool].takes) editor.draftTo(this.snapped(p, event.altKey));
  }

  /** @param {Pull} held @param {Point} pixel @param {Point} p */
  pull(held, pixel, p) {
    if (!this.editor.world || (!held.moves && away(pixel, held.pixel) < DRAG_PX)) return;
    held.moves = true;
    held.to = p;
    this.plan.choose({ list: held.list, item: moved(this.editor.world, held, held.from, held.to).now });
  }

  /** @param {PointerEvent} event */
  up(event) {
    const { editor, pressed: held } = this;
    this.pressed = null;
    if (!held || held.kind === "plan") return;
    const pixel = this.where(event);
    const p = this.plan.metres(pixel);
    if (held.kind === "thing") this.drop(held);
    else if (editor.tool === "delete") {
      const thing = this.plan.thingAt(p);
      if (thing) editor.remove(thing);
      else editor.wrong("There is nothing to delete here.");
    } else if (away(pixel, held.pixel) > DRAG_PX) editor.pressSecond(this.snapped(p, event.altKey));
  }

  /** @param {Pull} held */
  async drop(held) {
    const { editor } = this;
    if (!held.moves || away(held.from, held.to) < 1e-9) return editor.choose(editor.chosen);
    const done = await editor.office.edit((world) => moved(world, held, held.from, held.to).steps);
    editor.choose(editor.chosen);
    if (done) editor.say();
  }

  letGo() {
    this.pressed = null;
    this.editor.choose(this.editor.chosen);
  }

  // ---------------------------------------------------------------- keys

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.ctrlKey || event.metaKey || !this.editor.world || !this.means(event)) return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** True when the key had a meaning. @param {KeyboardEvent} event */
  means({ key, shiftKey, altKey }) {
    const { editor } = this;
    /** @type {Record<string, () => void>} */
    const actions = {
      Enter: () => this.enter(),
      " ": () => this.enter(),
      Escape: () => editor.escape(),
      Delete: () => editor.remove(editor.chosen),
      Backspace: () => editor.remove(editor.chosen),
      "+": () => this.plan.zoom(1.4),
      "-": () => this.plan.zoom(1 / 1.4),
      0: () => this.plan.fit(),
      o: () => editor.toggle(false),
      c: () => editor.time.toggle(),
    };
    const tool = altKey ? undefined : toolOf(key);
    if (key in ARROWS) this.step(ARROWS[key], shiftKey ? 5 : 1);
    else if (key in actions) actions[key]();
    else if (tool) editor.use(tool);
    else return false;
    return true;
  }

  // The cross that the arrow keys move begins in the middle of the visible part.
  get cross() {
    const { clientWidth, clientHeight } = $("plan");
    return this.plan.crosshair ?? this.snapped(this.plan.metres([clientWidth / 2, clientHeight / 2]), false);
  }

  /** @param {Point} direction @param {number} times */
  step([dx, dy], times) {
    const { editor } = this;
    const p = at(this.cross[0] + dx * times * this.grid, this.cross[1] + dy * times * this.grid);
    this.plan.cursor(p);
    this.plan.reveal(p);
    if (editor.points.length) editor.draftTo(p);
    editor.setStatus(`${p[0].toFixed(2)}, ${p[1].toFixed(2)} m. ${editor.hint}`, false);
  }

  enter() {
    const { editor } = this;
    const p = this.cross;
    this.plan.cursor(p);
    if (editor.tool === "select") {
      editor.choose(this.plan.thingAt(p));
      editor.setStatus(
        editor.chosen
          ? `${THINGS[editor.chosen.list].one} selected. Delete removes it; its values are in the form.`
          : "There is nothing here.",
        false,
      );
    } else if (editor.tool === "delete") editor.remove(this.plan.thingAt(p));
    else editor.press(p);
  }
}

/** @param {World} world @param {Place} place */
const itemOf = (world, { list, number }) => world[list]?.[number];

// The daylight against time: a small picture of the curve, and its points to type in.

import { keepingPlace, levelInput, make, mark, removeButton, timeInput } from "./elements.js";
import { svg } from "./icons.js";
import { NO_TIME, isLevel, seconds, time } from "./script.js";

const $ = (id) => document.getElementById(id);
const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [316, 112, 26, 8, 8, 20]; // of the picture and round its axes
const LEAST_S = 60;

export class DaylightForm {
  constructor(office, tell) {
    Object.assign(this, { office, tell, list: $("daylight-points"), form: $("daylight-add"), now_s: 0, level: 1, day: null });
    this.form.querySelector(".row").append(timeInput("Time of another point", "0:00"), levelInput("Level, 1 is as painted", 1));
    this.list.addEventListener("change", ({ target }) => this.change(target));
    this.list.addEventListener("click", ({ target }) => {
      const row = target.closest(".remove")?.closest("li");
      if (row) this.send(this.points.filter((_, k) => k !== Number(row.dataset.number)), "Point deleted. Ctrl+Z brings it back.");
    });
    $("daylight-repeat").addEventListener("change", ({ target }) => this.repeat(target));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.add();
    });
  }

  get points() {
    return this.day?.points ?? [];
  }

  show(world) {
    const text = JSON.stringify([world.daylight ?? null, world.script ?? null]);
    if (text === this.shown) return;
    this.shown = text;
    this.day = world.daylight ?? null;
    const rows = this.points.map(([at_s, level], number) => {
      const row = make("li", {}, timeInput("Time", time(at_s)), levelInput("Level", level), removeButton(`Delete the point at ${time(at_s)}`));
      row.dataset.number = number;
      return row;
    });
    keepingPlace(this.list, this.form, () => this.list.replaceChildren(...rows));
    const repeat = $("daylight-repeat");
    $("daylight-again").hidden = !this.day;
    $("daylight-none").hidden = this.day !== null;
    mark(repeat, false);
    if (!repeat.dataset.typed) repeat.value = this.day?.repeat_s ? time(this.day.repeat_s) : "";
    const scripted = (world.script ?? []).filter((item) => item.do === "daylight").map((item) => item.at_s);
    $("daylight-note").hidden = !this.day || !scripted.length;
    $("daylight-note").textContent = `From ${time(Math.min(...scripted, Infinity))} on the script sets the daylight; the curve counts until then.`;
    this.draw();
  }

  at(time_s, level) {
    if (time_s === this.now_s && level === this.level) return;
    Object.assign(this, { now_s: time_s, level });
    this.drawNow();
  }

  // ---------------------------------------------------------------- the picture

  get span_s() {
    const last = this.points.at(-1)?.[0] ?? 0;
    return this.day?.repeat_s || Math.max(LEAST_S, last * 1.25);
  }

  get most() {
    return Math.max(1.2, ...this.points.map(([, level]) => level * 1.1));
  }

  x(at_s) {
    return LEFT + ((WIDTH - LEFT - RIGHT) * Math.min(at_s, this.span_s)) / this.span_s;
  }

  y(level) {
    return HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * Math.min(level, this.most)) / this.most;
  }

  draw() {
    const [end, points] = [this.span_s, this.points.length ? this.points : [[0, 1]]];
    const curve = [[0, points[0][1]], ...points, [end, points.at(-1)[1]]].filter(([at_s]) => at_s <= end);
    const d = `M${curve.map(([at_s, level]) => `${this.x(at_s).toFixed(1)} ${this.y(level).toFixed(1)}`).join("L")}`;
    const label = (x, y, words, anchor) => svg("text", { x, y, "text-anchor": anchor }, words);
    $("daylight-curve").replaceChildren(
      svg("path", { d: `M${LEFT} ${this.y(1)}H${WIDTH - RIGHT}`, class: "painted" }),
      svg("path", { d: `M${LEFT} ${TOP}V${HEIGHT - BOTTOM}H${WIDTH - RIGHT}`, class: "axis" }),
      svg("path", { d: `${d}V${HEIGHT - BOTTOM}H${LEFT}Z`, class: "under" }), svg("path", { d, class: "curve" }),
      ...this.points.map(([at_s, level]) => svg("circle", { cx: this.x(at_s), cy: this.y(level), r: 4, class: "point" })),
      label(LEFT - 6, this.y(1) + 4, "1", "end"), label(LEFT - 6, HEIGHT - BOTTOM + 4, "0", "end"),
      label(LEFT, HEIGHT - 4, "0:00", "start"), label(WIDTH - RIGHT, HEIGHT - 4, this.day?.repeat_s ? `${time(end)}, then again` : time(Math.round(end)), "end"),
      svg("path", { class: "when" }), svg("circle", { r: 4.5, class: "here" }),
    );
    this.drawNow();
  }

  drawNow() {
    const [when, here] = [".when", ".here"].map((kind) => $("daylight-curve").querySelector(kind));
    if (!when) return;
    const x = this.x(this.day?.repeat_s ? this.now_s % this.day.repeat_s : this.now_s);
    when.setAttribute("d", `M${x.toFixed(1)} ${TOP}V${HEIGHT - BOTTOM}`);
    here.setAttribute("cx", x.toFixed(1));
    here.setAttribute("cy", this.y(this.level).toFixed(1));
    const words = `Daylight against time. Now: ${this.level.toFixed(2)}`;
    if ($("daylight-curve").getAttribute("aria-label") !== words) $("daylight-curve").setAttribute("aria-label", words);
    if ($("daylight-now").textContent !== this.level.toFixed(2)) $("daylight-now").textContent = this.level.toFixed(2);
  }

  // ---------------------------------------------------------------- what is done

  // A point as a row or the form says it, or null when it says none. `number`: its own, so that it may stay where it is.
  read(place, number = -1) {
    const [when, level] = [place.querySelector(".when"), place.querySelector(".level")];
    const at_s = seconds(when.value);
    const taken = this.points.some(([other], k) => other === at_s && k !== number);
    mark(when, isNaN(at_s) || taken);
    mark(level, !isLevel(level.value));
    if (isNaN(at_s)) this.tell(NO_TIME(when.value), true);
    else if (taken) this.tell(`There is a point at ${time(at_s)} already; change that one.`, true);
    else if (!isLevel(level.value)) this.tell(`“${level.value}” is no level; write a number from 0, which is dark, to 3. 1 is as painted.`, true);
    else return [at_s, Number(level.value)];
    return null;
  }

  send(points, words, repeat_s = this.day?.repeat_s ?? 0) {
    return this.office.edit(() => {
      const item = { points: [...points].sort((a, b) => a[0] - b[0]), repeat_s };
      if (!points.length) return [{ do: "delete", list: "daylight", number: 0 }];
      return [this.day ? { do: "change", list: "daylight", number: 0, item } : { do: "add", list: "daylight", item }];
    }).then((done) => {
      if (done) this.tell(words, false);
      return done;
    });
  }

  async add() {
    const point = this.read(this.form);
    if (!point || !(await this.send([...this.points, point], `Added: daylight ${point[1]} at ${time(point[0])}.`))) return;
    this.form.querySelector(".when").focus();
    this.form.querySelector(".when").select();
  }

  async change(target) {
    delete target.dataset.typed;
    const row = target.closest("li");
    const number = Number(row.dataset.number);
    const point = this.read(row, number);
    if (!point) return;
    if (!(await this.send(this.points.map((was, k) => (k === number ? point : was)), "Changed. Ctrl+Z takes it back."))) mark(target, true);
  }

  async repeat(input) {
    delete input.dataset.typed;
    const repeat_s = input.value.trim() === "" ? 0 : seconds(input.value);
    mark(input, isNaN(repeat_s));
    if (isNaN(repeat_s)) this.tell(NO_TIME(input.value), true);
    else if (!(await this.send(this.points, repeat_s ? `The daylight begins again every ${time(repeat_s)}.` : "The daylight stays at its last point.", repeat_s))) mark(input, true);
  }
}

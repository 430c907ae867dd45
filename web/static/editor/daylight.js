// The daylight against time: a small picture of the curve, and its points in fields.

import { $, field, find, make, removeButton, svg, within } from "../ui/elements.js";
import { isLevel, keepingPlace, levelInput, mark, NO_LEVEL, NO_TIME, seconds, time, timeInput } from "./times.js";

export const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [316, 112, 26, 8, 8, 20]; // of the picture, and margins around its axes
const LEAST_S = 60;

/** The daylight against time as a curve in a small picture. */
export class DaylightCurve {
  /** @param {DaylightItem | null} day */
  constructor(day) {
    this.points = day?.points ?? [];
    this.repeat_s = day?.repeat_s ?? 0;
    this.span_s = this.repeat_s || Math.max(LEAST_S, (this.points.at(-1)?.[0] ?? 0) * 1.25);
    this.most = Math.max(1.2, ...this.points.map(([, level]) => level * 1.1));
  }

  /** @param {number} at_s */
  x(at_s) {
    return LEFT + ((WIDTH - LEFT - RIGHT) * Math.min(at_s, this.span_s)) / this.span_s;
  }

  /** @param {number} level */
  y(level) {
    return HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * Math.min(level, this.most)) / this.most;
  }

  /** Where a moment is in the picture; if the curve repeats, within its period. @param {number} now_s */
  now(now_s) {
    return this.x(this.repeat_s ? now_s % this.repeat_s : now_s);
  }

  /** The curve as a path: level before the first point and after the last. */
  get path() {
    const [first, last] = [this.points[0]?.[1] ?? 1, this.points.at(-1)?.[1] ?? 1];
    const curve = [[0, first], ...this.points, [this.span_s, last]].filter(([at_s]) => at_s <= this.span_s);
    return `M${curve.map(([at_s, level]) => `${this.x(at_s).toFixed(1)} ${this.y(level).toFixed(1)}`).join("L")}`;
  }
}

export class DaylightForm {
  /** @param {import("./world_client.js").WorldClient} office @param {SetStatus} setStatus */
  constructor(office, setStatus) {
    this.office = office;
    this.setStatus = setStatus;
    this.list = $("daylight-points");
    this.form = $("daylight-add");
    this.now_s = 0;
    this.level = 1;
    /** @type {DaylightItem | null} */
    this.day = null;
    this.curve = new DaylightCurve(null);
    this.shown = ""; // the world's daylight and script as they were drawn
    find(this.form, ".row").append(timeInput("Time of another point", "0:00"), levelInput("Level, 1 is as painted", 1));
    this.list.addEventListener("change", (event) => this.change(field(event)));
    this.list.addEventListener("click", (event) => {
      const row = within(event, ".remove")?.closest("li");
      if (row)
        this.send(
          this.points.filter((_, k) => k !== Number(row.dataset.number)),
          "Point deleted. Ctrl+Z brings it back.",
        );
    });
    $("daylight-repeat").addEventListener("change", (event) => this.repeat(field(event)));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.add();
    });
  }

  get points() {
    return this.day?.points ?? [];
  }

  /** @param {World} world */
  show(world) {
    const text = JSON.stringify([world.daylight ?? null, world.script ?? null]);
    if (text === this.shown) return;
    this.shown = text;
    this.day = world.daylight ?? null;
    this.curve = new DaylightCurve(this.day);
    const rows = this.points.map(([at_s, level], number) => {
      const row = make(
        "li",
        {},
        timeInput("Time", time(at_s)),
        levelInput("Level", level),
        removeButton(`Delete the point at ${time(at_s)}`),
      );
      row.dataset.number = String(number);
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
    $("daylight-note").textContent =
      `From ${time(Math.min(...scripted, Infinity))} on the script sets the daylight; the curve counts until then.`;
    this.draw();
  }

  /** @param {number} time_s @param {number} level */
  at(time_s, level) {
    if (time_s === this.now_s && level === this.level) return;
    this.now_s = time_s;
    this.level = level;
    this.drawNow();
  }

  // ---------------------------------------------------------------- the picture

  draw() {
    const { curve } = this;
    const label = (/** @type {number} */ x, /** @type {number} */ y, /** @type {string} */ words, anchor = "end") =>
      svg("text", { x, y, "text-anchor": anchor }, words);
    const [right, floor, end] = [WIDTH - RIGHT, HEIGHT - BOTTOM, time(Math.round(curve.span_s))];
    $("daylight-curve").replaceChildren(
      svg("path", { d: `M${LEFT} ${curve.y(1)}H${right}`, class: "painted" }),
      svg("path", { d: `M${LEFT} ${TOP}V${floor}H${right}`, class: "axis" }),
      svg("path", { d: `${curve.path}V${floor}H${LEFT}Z`, class: "under" }),
      svg("path", { d: curve.path, class: "curve" }),
      ...this.points.map(([at_s, level]) =>
        svg("circle", { cx: curve.x(at_s), cy: curve.y(level), r: 4, class: "point" }),
      ),
      label(LEFT - 6, curve.y(1) + 4, "1"),
      label(LEFT - 6, floor + 4, "0"),
      label(LEFT, HEIGHT - 4, "0:00", "start"),
      label(right, HEIGHT - 4, curve.repeat_s ? `${time(curve.repeat_s)}, then again` : end),
      svg("path", { class: "when" }),
      svg("circle", { r: 4.5, class: "here" }),
    );
    this.drawNow();
  }

  drawNow() {
    const [when, here] = [".when", ".here"].map((kind) => $("daylight-curve").querySelector(kind));
    if (!when || !here) return;
    const x = this.curve.now(this.now_s);
    when.setAttribute("d", `M${x.toFixed(1)} ${TOP}V${HEIGHT - BOTTOM}`);
    here.setAttribute("cx", x.toFixed(1));
    here.setAttribute("cy", this.curve.y(this.level).toFixed(1));
    const words = `Daylight against time. Now: ${this.level.toFixed(2)}`;
    if ($("daylight-curve").getAttribute("aria-label") !== words) $("daylight-curve").setAttribute("aria-label", words);
    if ($("daylight-now").textContent !== this.level.toFixed(2)) $("daylight-now").textContent = this.level.toFixed(2);
  }

  // ---------------------------------------------------------------- what is done

  /**
   * The point in a row or in the form, or null when what is typed there is none.
   * @param {HTMLElement} place
   * @param {number} [number] the point's own number, so that it may stay where it is
   * @returns {Point | null}
   */
  read(place, number = -1) {
    /** @type {HTMLInputElement[]} */
    const [when, level] = [find(place, ".when"), find(place, ".level")];
    const at_s = seconds(when.value);
    const taken = this.points.some(([other], k) => other === at_s && k !== number);
    mark(when, Number.isNaN(at_s) || taken);
    mark(level, !isLevel(level.value));
    if (Number.isNaN(at_s)) this.setStatus(NO_TIME(when.value), true);
    else if (taken) this.setStatus(`There is a point at ${time(at_s)} already; change that one.`, true);
    else if (!isLevel(level.value)) this.setStatus(NO_LEVEL(level.value), true);
    else return [at_s, Number(level.value)];
    return null;
  }

  /** @param {Point[]} points @param {string} words @param {number} [repeat_s] */
  async send(points, words, repeat_s = this.day?.repeat_s ?? 0) {
    const item = { points: [...points].sort((a, b) => a[0] - b[0]), repeat_s };
    const done = await this.office.edit(() => {
      if (!points.length) return [{ do: "delete", list: "daylight", number: 0 }];
      return [this.day ? { do: "change", list: "daylight", number: 0, item } : { do: "add", list: "daylight", item }];
    });
    if (done) this.setStatus(words, false);
    return done;
  }

  async add() {
    const point = this.read(this.form);
    if (!point || !(await this.send([...this.points, point], `Added: daylight ${point[1]} at ${time(point[0])}.`)))
      return;
    /** @type {HTMLInputElement} */
    const when = find(this.form, ".when");
    when.focus();
    when.select();
  }

  /** @param {HTMLInputElement} target */
  async change(target) {
    delete target.dataset.typed;
    const row = target.closest("li");
    if (!row) return;
    const number = Number(row.dataset.number);
    const point = this.read(row, number);
    if (!point) return;
    if (
      !(await this.send(
        this.points.map((was, k) => (k === number ? point : was)),
        "Changed. Ctrl+Z takes it back.",
      ))
    )
      mark(target, true);
  }

  /** @param {HTMLInputElement} input */
  async repeat(input) {
    delete input.dataset.typed;
    const repeat_s = input.value.trim() === "" ? 0 : seconds(input.value);
    mark(input, Number.isNaN(repeat_s));
    if (Number.isNaN(repeat_s)) this.setStatus(NO_TIME(input.value), true);
    else if (
      !(await this.send(
        this.points,
        repeat_s ? `The daylight begins again every ${time(repeat_s)}.` : "The daylight stays at its last point.",
        repeat_s,
      ))
    )
      mark(input, true);
  }
}

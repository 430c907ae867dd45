// What happens when: the lines of the world's script, sorted by time, to add, change and delete, and the daylight below them.

import { $, field, find, labelled, make, removeButton, within } from "../ui/elements.js";
import {
  ACTIONS,
  firstAction,
  isLevel,
  keepingPlace,
  levelInput,
  line,
  mark,
  namesOf,
  NO_LEVEL,
  NO_TIME,
  seconds,
  time,
  timeInput,
} from "./times.js";
import { DaylightForm } from "./daylight.js";
import { SCRIPT_ACTIONS } from "../shared.js";

/** @typedef {import("./times.js").Action} Action */
/** What the form for another line holds. @typedef {{ at_s: number, do: Action, text?: string, name?: string, level?: number }} Draft */

export class TimePanel {
  /** @param {import("./world_client.js").WorldClient} office @param {SetStatus} setStatus for the status line */
  constructor(office, setStatus) {
    this.office = office;
    this.setStatus = setStatus;
    this.box = $("time");
    this.list = $("script-lines");
    this.form = $("script-add");
    this.now_s = 0;
    this.level = 1;
    this.shown = ""; // the lines as they were last drawn
    this.names = ""; // that can be chosen in the form
    /** @type {number | null} */
    this.place = null; // of the mark for the present moment among the lines
    this.daylight = new DaylightForm(office, setStatus);
    this.now = make("li", { className: "now" });
    $("edit-time").addEventListener("click", () => this.toggle());
    $("time-close").addEventListener("click", () => this.toggle(false));
    this.box.addEventListener("input", (event) => {
      field(event).dataset.typed = "yes";
    });
    this.box.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.toggle(false);
    });
    this.list.addEventListener("change", (event) => this.change(field(event)));
    this.list.addEventListener("click", (event) => {
      const row = within(event, ".remove")?.closest("li");
      if (row) this.remove(Number(row.dataset.number));
    });
    this.form.addEventListener(
      "change",
      (event) => field(event).className === "what" && this.draw(this.draft(field(event))),
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.add();
    });
  }

  toggle(on = this.box.hidden) {
    this.box.hidden = !on;
    $("edit-time").setAttribute("aria-expanded", String(on));
    if (!on) return $("edit-time").focus();
    this.show(this.office.world);
    this.draw({ at_s: Math.ceil((this.now_s + 1) / 10) * 10, do: firstAction(this.office.world) });
    this.box.focus({ preventScroll: true }); // not a field, since a phone would cover it with its keyboard
  }

  // ---------------------------------------------------------------- what there is

  /** @param {World | null} world */
  show(world) {
    if (this.box.hidden || !world) return; // a thousand lines take a while
    const kinds = /** @type {const} */ (["doors", "lamps", "boxes"]).map((list) => namesOf(world, list));
    const names = JSON.stringify(kinds);
    const text = JSON.stringify([world.script, names]);
    if (text !== this.shown) {
      this.shown = text;
      const rows = (world.script ?? [])
        .map((item, number) => ({ item, number }))
        .sort((a, b) => a.item.at_s - b.item.at_s || a.number - b.number);
      keepingPlace(this.list, this.form, () => this.list.replaceChildren(...rows.map((row) => this.row(world, row))));
      $("script-none").hidden = rows.length > 0;
      this.place = null;
    }
    if (names !== this.names) {
      this.names = names; // only then: whoever types the next line is not to be interrupted by the one before
      this.draw(this.draft());
    }
    this.daylight.show(world);
    this.at(this.now_s);
  }

  /** @param {World} world @param {{ item: EventItem, number: number }} line */
  row(world, { item, number }) {
    const row = make("li", {}, ...controls(world, item), removeButton(`Delete the line at ${time(item.at_s)}`));
    Object.assign(row.dataset, { number: String(number), at: String(item.at_s) });
    return row;
  }

  /** The form for another line, filled in with `item`. @param {Draft} item */
  draw(item) {
    const world = this.office.world;
    if (!world) return;
    const had = this.form.contains(document.activeElement) ? document.activeElement?.classList[0] : null;
    const [when, ...rest] = controls(world, line(world, item.at_s, item.do, item.name ?? item.level ?? null));
    if (item.text !== undefined) when.value = item.text;
    find(this.form, ".row").replaceChildren(when, ...rest);
    if (had) find(this.form, `.${had}`)?.focus();
  }

  /** @param {HTMLElement | null} changed @returns {Draft} */
  draft(changed = null) {
    const [when, what, which] = parts(this.form);
    if (!when || !what) return { at_s: 0, do: firstAction(this.office.world) };
    const value = changed === what ? undefined : (which?.value ?? undefined);
    return { at_s: 0, text: when.value, do: /** @type {Action} */ (what.value), name: value };
  }

  /** The present moment: lines above its mark are in the past. @param {number} time_s */
  at(time_s, level = this.level) {
    this.now_s = time_s;
    this.level = level;
    this.daylight.at(time_s, level);
    if (this.box.hidden) return;
    const words = `now ${time(Math.floor(time_s))}`;
    if (this.now.textContent !== words) this.now.textContent = words;
    /** @type {HTMLElement[]} */
    const rows = [...this.list.querySelectorAll("li[data-at]")].map((row) => /** @type {HTMLElement} */ (row));
    const next = rows.findIndex((row) => Number(row.dataset.at) > time_s + 1e-9);
    if (this.place === next && this.now.isConnected === rows.length > 0) return;
    this.place = next;
    for (const [k, row] of rows.entries()) row.classList.toggle("past", next < 0 || k < next);
    if (!rows.length) this.now.remove();
    else if (next < 0) this.list.append(this.now);
    else rows[next].before(this.now);
  }

  // ---------------------------------------------------------------- what is done

  /** The line in a row or in the form, or null when it is none. @param {HTMLElement} place @param {HTMLElement | null} changed */
  read(place, changed = null) {
    const [when, what, which] = parts(place);
    if (!when || !what || !this.office.world) return null;
    const at_s = seconds(when.value);
    const noLevel = what.value === "daylight" && changed !== what && which !== null && !isLevel(which.value);
    mark(when, Number.isNaN(at_s));
    if (which) mark(which, noLevel);
    if (Number.isNaN(at_s)) this.setStatus(NO_TIME(when.value), true);
    else if (noLevel) this.setStatus(NO_LEVEL(which.value), true);
    else
      return line(
        this.office.world,
        at_s,
        /** @type {Action} */ (what.value),
        changed === what ? null : (which?.value ?? null),
      );
    return null;
  }

  async add() {
    const item = this.read(this.form);
    const typed = parts(this.form)[0]?.value;
    if (!item || !(await this.office.edit(() => [{ do: "add", list: "script", item }]))) return;
    const words = `${time(item.at_s)}: ${ACTIONS[item.do].title.toLowerCase()} ${item.name ?? item.level ?? ""}`.trim();
    this.setStatus(
      item.at_s > this.now_s ? `Added: at ${words}.` : `Added: at ${words}. That is past; it happens after a restart.`,
      false,
    );
    /** @type {HTMLInputElement} */
    const when = find(this.form, ".when");
    if (when.value !== typed) return; // the next line is being typed already
    when.focus();
    when.select();
  }

  /** @param {HTMLInputElement} target */
  async change(target) {
    const row = target.closest("li");
    if (!row) return;
    delete target.dataset.typed;
    const item = this.read(row, target);
    if (!item) return;
    const done = await this.office.edit(() => [
      { do: "change", list: "script", number: Number(row.dataset.number), item },
    ]);
    if (done) this.setStatus("Changed. Ctrl+Z takes it back.", false);
    else mark(target, true);
  }

  /** @param {number} number */
  async remove(number) {
    if (await this.office.edit(() => [{ do: "delete", list: "script", number }]))
      this.setStatus("Line deleted. Ctrl+Z brings it back.", false);
  }
}

/**
 * The three fields of a line.
 * @param {HTMLElement} place
 * @returns {(HTMLInputElement | null)[]}
 */
const parts = (place) => [".when", ".what", ".which, .level"].map((kind) => place.querySelector(kind));

/**
 * The fields for time, action and thing, of a line that is there or of the one to add.
 * @param {World} world
 * @param {EventItem} item
 * @returns {[HTMLInputElement, HTMLElement, HTMLElement]}
 */
function controls(world, item) {
  const what = labelled("What happens", make("select", { className: "what" }));
  for (const action of SCRIPT_ACTIONS) {
    const { title, of } = ACTIONS[action];
    const none = of !== undefined && action !== item.do && !namesOf(world, of).length;
    what.append(make("option", { value: action, textContent: none ? `${title} (no ${of})` : title, disabled: none }));
  }
  what.value = item.do;
  return [timeInput("Time", time(item.at_s)), what, which(world, item)];
}

/** @param {World} world @param {EventItem} item */
function which(world, item) {
  const { of } = ACTIONS[item.do];
  if (item.do === "daylight") return levelInput("Level of the daylight, 1 is as painted", item.level ?? 1);
  if (!of) return make("span", { className: "nothing" });
  const select = labelled(
    `Which of the ${of}`,
    make("select", { className: "which" }, ...namesOf(world, of).map((name) => new Option(name))),
  );
  select.value = item.name ?? "";
  select.title = select.value; // which may be too long for its place
  return select;
}

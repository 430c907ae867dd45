// Small pieces of the panel: tables, notes, choices, bars and switches. What the server says only ever becomes text.

import { make, say } from "../ui/elements.js";

/** @param {string} words */
export const heading = (words) => make("h2", { textContent: words });

/** @param {string} words */
export const note = (words) => make("p", { className: "quiet", textContent: words });

/** @param {string} words */
export const caption = (words) => make("p", { className: "caption", textContent: words });

/** @typedef {{ title: string, rows: [string, string][], empty: string }} TableData */

/** Two columns of words under a title; without rows, it says why there are none. */
export class Table {
  constructor() {
    this.title = heading("");
    this.body = make("tbody");
    this.table = make("table", {}, this.body);
    this.empty = note("");
    this.box = make("section", {}, this.title, this.table, this.empty);
  }

  /** @param {TableData} data */
  show({ title, rows, empty }) {
    say(this.title, title);
    while (this.body.rows.length > rows.length) this.body.deleteRow(-1);
    rows.forEach(([name, value], k) => {
      const row = this.body.rows[k] ?? this.add();
      say(row.cells[0], name);
      say(row.cells[1], value);
    });
    this.table.hidden = rows.length === 0;
    this.empty.hidden = rows.length > 0;
    say(this.empty, empty);
    return this;
  }

  add() {
    const row = this.body.insertRow();
    row.append(make("th", { scope: "row" }), make("td"));
    return row;
  }
}

/** Tables one below the other, as many as there are. */
export class Tables {
  constructor() {
    this.box = make("div");
    /** @type {Table[]} */
    this.tables = [];
  }

  /** @param {TableData[]} datas */
  show(datas) {
    while (this.tables.length < datas.length) {
      this.tables.push(new Table());
      this.box.append(this.tables[this.tables.length - 1].box);
    }
    while (this.tables.length > datas.length) this.tables.pop()?.box.remove();
    datas.forEach((data, k) => {
      this.tables[k].show(data);
    });
  }
}

/** A bar filled to a share of its width, with a mark across it at another share. */
export class Bar {
  /** @param {number | null} mark */
  constructor(mark = null) {
    this.fill = make("span", { className: "fill" });
    this.box = make("div", { className: "bar" }, this.fill);
    this.box.setAttribute("aria-hidden", "true"); // the words beside it say the same
    if (mark === null) return;
    const line = make("span", { className: "across" });
    line.style.left = `${100 * mark}%`;
    this.box.append(line);
  }

  /** @param {number} share @param {string} [tone] */
  show(share, tone = "") {
    this.fill.style.width = `${(100 * Math.min(Math.max(share, 0), 1)).toFixed(1)}%`;
    this.box.dataset.tone = tone;
  }
}

/**
 * A number that a click inspects.
 * @param {string} kind "experience" or "view"
 * @param {number} number
 * @param {string} text
 * @param {(wish: Record<string, number>) => void} inspect
 */
export function choice(kind, number, text, inspect) {
  const button = make("button", { type: "button", className: "choice", textContent: text });
  button.dataset.key = `${kind} ${number}`;
  button.setAttribute("aria-label", `${text}: inspect ${kind} ${number}`);
  button.addEventListener("click", () => inspect({ [kind]: number }));
  return button;
}

/** @typedef {{ name: string, tab: string, words: string, hint: string, on: boolean }} Switch */

export class SwitchList {
  /** @param {string} tab @param {import("./panel.js").Ask} ask */
  constructor(tab, ask) {
    this.tab = tab;
    this.ask = ask;
    this.box = make("div", { className: "switches" });
    /** @type {Map<string, HTMLInputElement>} */
    this.inputs = new Map();
  }

  /** @param {{ switches: Switch[] }} data */
  show({ switches }) {
    for (const of of switches.filter(({ tab }) => tab === this.tab)) {
      const input = this.inputs.get(of.name) ?? this.add(of);
      input.checked = of.on;
    }
  }

  /** @param {Switch} of */
  add({ name, words, hint }) {
    const input = make("input", { type: "checkbox" });
    input.addEventListener("change", () => this.ask({ type: "switch", name, on: input.checked }));
    this.box.append(make("label", { className: "check", title: hint }, input, make("span", { textContent: words })));
    this.inputs.set(name, input);
    return input;
  }
}

// Small pieces of the panel: tables, notes, choices, bars, switches, and pictures made of numbers. What the server says only ever
// becomes text.

import { make, say, svg } from "../ui/elements.js";

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

/** The switches of one tab that all pages share (web/switches.py). */
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

/**
 * @typedef {[number, number, number]} Rgb
 * @typedef {{ width: number, height: number, rgba: Uint8ClampedArray<ArrayBuffer> }} Pixels
 */

/** @param {string} colour "#rgb" or "#rrggbb" @returns {Rgb} */
export function rgb(colour) {
  const digits = colour.trim().slice(1);
  const pairs = digits.length === 3 ? [...digits].map((digit) => digit + digit) : (digits.match(/../g) ?? []);
  const [red = 0, green = 0, blue = 0] = pairs.map((pair) => Number.parseInt(pair, 16));
  return [red, green, blue];
}

/** `share` of the way from one colour to another. @param {Rgb} from @param {Rgb} to @param {number} share @returns {Rgb} */
export function mix(from, to, share) {
  const [red, green, blue] = from.map((value, k) => value + (to[k] - value) * share);
  return [red, green, blue];
}

/**
 * A picture of grey levels (height, width) or colours (height, width, 3), as they are.
 * @param {ArrayLike<number>} values
 * @param {number[]} shape
 * @returns {Pixels}
 */
export function picture(values, [height, width, channels = 1]) {
  const rgba = new Uint8ClampedArray(4 * width * height);
  for (let k = 0; k < width * height; k++) {
    for (let c = 0; c < 3; c++) rgba[4 * k + c] = values[channels * k + (channels === 3 ? c : 0)];
    rgba[4 * k + 3] = 255;
  }
  return { width, height, rgba };
}

/**
 * Bars on a common floor, as the path of an SVG of `values.length` by 100. The tallest reaches the top.
 * @param {ArrayLike<number>} values
 */
export function bars(values) {
  const tallest = Math.max(1e-9, ...Array.from(values));
  let path = "";
  for (let k = 0; k < values.length; k++) {
    const height = (100 * values[k]) / tallest;
    if (height > 0.5) path += `M${(k + 0.08).toFixed(2)} 100V${(100 - height).toFixed(1)}h.84V100z`;
  }
  return path;
}

/** A colour of the page's theme. @param {string} name of a custom property, without its dashes */
export const colourOf = (name) => rgb(getComputedStyle(document.documentElement).getPropertyValue(`--${name}`));

/** Pixels in a canvas as they are, enlarged without smoothing. */
export class Picture {
  /** @param {string} words what it shows, for people who cannot see it: from the beginning, before there is anything to show */
  constructor(words) {
    this.canvas = make("canvas", { width: 1, height: 1, className: "pixels" });
    this.canvas.setAttribute("role", "img");
    this.says(words);
    this.turn = 0; // number of the latest request: a picture that is unpacked after a newer one is dropped
  }

  /** @param {string} words what it shows now */
  says(words) {
    if (this.canvas.getAttribute("aria-label") !== words) this.canvas.setAttribute("aria-label", words);
    return this;
  }

  /** @param {Pixels} pixels */
  draw({ width, height, rgba }) {
    this.turn += 1;
    this.size(width, height);
    this.canvas.getContext("2d")?.putImageData(new ImageData(rgba, width, height), 0, 0);
  }

  /** @param {import("../net/connection.js").Parcel | undefined} parcel */
  async show(parcel) {
    if (!parcel) return;
    this.canvas.hidden = parcel.kind !== "jpeg" && parcel.values.length === 0; // the source has no such picture
    if (this.canvas.hidden) return;
    if (parcel.kind !== "jpeg") return this.draw(picture(parcel.values, parcel.shape));
    const turn = ++this.turn;
    const image = await createImageBitmap(new Blob([parcel.values], { type: "image/jpeg" }));
    if (turn === this.turn) {
      this.size(image.width, image.height);
      this.canvas.getContext("2d")?.drawImage(image, 0, 0);
    }
    image.close();
  }

  /** @param {number} width @param {number} height */
  size(width, height) {
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }
}

/** Activity by heading: bars on a common floor, 0° to 360°. */
export class Histogram {
  /** @param {string} words */
  constructor(words) {
    this.path = svg("path", {});
    this.drawing = svg(
      "svg",
      { role: "img", "aria-label": words, preserveAspectRatio: "none", class: "bars" },
      this.path,
    );
    const ticks = ["0°", "180°", "360°"].map((tick) => make("span", { textContent: tick }));
    this.box = make("div", { className: "histogram" }, this.drawing, make("div", { className: "ticks" }, ...ticks));
  }

  /** @param {ArrayLike<number>} values */
  show(values) {
    this.drawing.setAttribute("viewBox", `0 0 ${values.length} 100`);
    this.path.setAttribute("d", bars(values));
  }
}

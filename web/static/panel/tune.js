// Tune: the dozen that a lecture turns, then every parameter as a control, by section; a search finds it by any of its words.

import { icon, labelled, make, say } from "../ui/elements.js";

/**
 * A parameter as the server sends it (web/panel/tune.py).
 * @typedef {{
 *   name: string, value: number | boolean | string, default: number | boolean | string, symbol: string, unit: string,
 *   low: number | null, high: number | null, step: number | null, choices: string[], live: boolean, lecture: boolean,
 *   meaning: string, hint: string,
 * }} Parameter
 */

/** The name of a parameter within its group. @param {string} name */
export const shortName = (name) => name.slice(name.lastIndexOf(".") + 1).replaceAll("_", " ");

/** The heading of its group. @param {string} name */
export const groupOf = (name) => name.slice(0, Math.max(0, name.lastIndexOf("."))).replaceAll("_", " ") || "all";

/**
 * The parameters by group, in their order.
 * @template {{ name: string }} T
 * @param {T[]} parameters
 * @returns {Map<string, T[]>}
 */
export function grouped(parameters) {
  /** @type {Map<string, T[]>} */
  const groups = new Map();
  for (const parameter of parameters) {
    const group = groupOf(parameter.name);
    groups.set(group, [...(groups.get(group) ?? []), parameter]);
  }
  return groups;
}

/** @type {Record<string, string>} as people type them */
const GREEK = {
  α: "alpha",
  β: "beta",
  γ: "gamma",
  δ: "delta",
  ε: "epsilon",
  η: "eta",
  θ: "theta",
  μ: "mu",
  σ: "sigma",
  τ: "tau",
  φ: "phi",
  ω: "omega",
};

/**
 * Whether a search finds this parameter: each word searched for is in its name, symbol, unit or meaning.
 * @param {Pick<Parameter, "name" | "symbol" | "unit" | "hint">} parameter
 * @param {string} search
 */
export function means({ name, symbol, unit, hint }, search) {
  const spelt = [...symbol].map((letter) => GREEK[letter] ?? letter).join("");
  const text = `${name} ${name.replaceAll("_", " ")} ${symbol} ${spelt} ${unit} ${hint}`.toLowerCase();
  return search
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
}

/** A symbol as it is printed: the part on the line, and the subscript. @param {string} symbol @returns {[string, string]} */
export function printed(symbol) {
  const [base, ...below] = symbol.split("_");
  return [base, below.join("_").replace(/^\{(.*)\}$/, "$1")];
}

/** Whether the value is the default. @param {Pick<Parameter, "value" | "default">} parameter */
export const isDefault = (parameter) => parameter.value === parameter.default;

let count = 0;

/** One parameter as a control: its name, symbol and unit, its value, and a way back to the default; its meaning, if `told`. */
export class Knob {
  /** @param {Parameter} parameter @param {import("./panel.js").Ask} ask */
  constructor(parameter, ask, told = false) {
    this.ask = ask;
    this.parameter = parameter;
    /** @type {Parameter["value"] | undefined} the newest value chosen while an answer is awaited */
    this.next = undefined;
    this.asking = false;
    this.input = control(parameter);
    this.input.addEventListener("input", () => (this.input.dataset.typed = "yes"));
    this.input.addEventListener("change", () => this.turned(this.read()));
    this.reset = labelled(
      `Back to the default, ${parameter.default}`,
      make("button", { type: "button", className: "bare" }, icon("undo")),
    );
    this.reset.addEventListener("click", () => this.turned(this.parameter.default));
    const hint = make("span", { id: `hint-${++count}`, className: "gone", textContent: parameter.hint });
    this.input.setAttribute("aria-describedby", hint.id);
    const label = make("label", {}, words(parameter), this.input);
    this.box = make("div", { className: "knob", title: parameter.hint }, label, this.reset, hint);
    if (told) this.box.append(make("p", { ariaHidden: "true", textContent: parameter.meaning })); // the hint has it, too
    this.show(parameter);
  }

  /** Shows the session's value; text that somebody is typing stays. @param {Parameter} parameter */
  show(parameter) {
    this.parameter = parameter;
    this.reset.hidden = isDefault(parameter);
    if (this.asking || (this.input.dataset.typed && document.activeElement === this.input)) return;
    if (this.input.type === "checkbox") /** @type {HTMLInputElement} */ (this.input).checked = Boolean(parameter.value);
    else if (this.input.value !== String(parameter.value)) this.input.value = String(parameter.value);
  }

  read() {
    if (this.input.type === "checkbox") return /** @type {HTMLInputElement} */ (this.input).checked;
    return typeof this.parameter.value === "number" ? Number(this.input.value) : this.input.value;
  }

  /** Sends one command at a time. Of the values chosen meanwhile, the newest is sent next. @param {Parameter["value"]} value */
  async turned(value) {
    delete this.input.dataset.typed;
    this.next = value;
    if (this.asking) return;
    this.asking = true;
    while (this.next !== undefined) {
      const wish = this.next;
      this.next = undefined;
      const answer = await this.ask({ type: "set_parameter", name: this.parameter.name, value: wish });
      if (answer.accepted) this.parameter = { ...this.parameter, value: wish };
    }
    this.asking = false;
    this.show(this.parameter); // after a refusal, the old value is shown again
  }
}

/** @param {Parameter} parameter */
function words({ name, symbol, unit, live }) {
  const parts = [make("span", { textContent: shortName(name) })];
  if (unit) parts.push(make("small", { textContent: unit }));
  if (!live) parts.push(labelled("takes effect at reset", make("small", { textContent: "↻", role: "img" })));
  const [base, below] = printed(symbol);
  const sign = make("i", {}, base, ...(below ? [make("sub", { textContent: below })] : []));
  return make("span", { className: "words" }, ...(symbol ? [sign, " "] : []), ...parts.flatMap((part) => [part, " "]));
}

/** @param {Parameter} parameter */
function control({ value, choices, low, high, step }) {
  if (typeof value === "boolean") return make("input", { type: "checkbox" });
  if (choices.length) return make("select", {}, ...choices.map((choice) => new Option(choice)));
  if (typeof value === "string") return make("input", { type: "text", maxLength: 64, autocomplete: "off" });
  const limit = (/** @type {number | null} */ end) => (end === null ? "" : String(end));
  return make("input", { type: "number", min: limit(low), max: limit(high), step: String(step ?? "any") });
}

const POINT = "Point at a name, or tab to its field, for its meaning. ↻ takes effect at reset.";

export class TuneTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.ask = ask;
    this.search = make("input", { type: "search", autocomplete: "off" });
    this.search.setAttribute("aria-label", "Search the parameters");
    this.search.addEventListener("input", () => this.find());
    this.found = make("p", { className: "quiet" });
    this.found.setAttribute("role", "status");
    this.dozen = make("section", { className: "dozen" });
    this.groups = make("div");
    const all = make("div", { className: "all" }, this.dozen, this.groups);
    this.hint = make("p", { className: "hint", textContent: POINT });
    this.hint.setAttribute("aria-hidden", "true"); // each control has a description of its own
    const head = make("div", { className: "search" }, this.search, this.found);
    this.box = make("div", { className: "tune" }, head, all, this.hint);
    for (const kind of /** @type {const} */ (["pointerover", "focusin"]))
      all.addEventListener(kind, (event) => this.explain(/** @type {Element} */ (event.target)));
    /** @type {Map<string, Knob>} */
    this.knobs = new Map();
    /** @type {Knob[]} those of the dozen, which have one in their section, too */
    this.lecture = [];
    /** @type {Map<string, HTMLElement>} how many of a section are not at their default */
    this.changed = new Map();
    /** @type {HTMLElement[]} how many each section has, of which a search finds so many */
    this.sizes = [];
    this.sought = ""; // which one is to have the focus as soon as it is there
  }

  /** @param {{ knobs: Parameter[] }} data */
  tune({ knobs }) {
    if (String(knobs.map(({ name }) => name)) !== String([...this.knobs.keys()])) this.build(knobs);
    for (const parameter of knobs) this.knobs.get(parameter.name)?.show(parameter);
    for (const knob of this.lecture) knob.show(this.knobs.get(knob.parameter.name)?.parameter ?? knob.parameter);
    for (const [group, members] of grouped(knobs)) {
      const changed = members.filter((parameter) => !isDefault(parameter)).length;
      this.changed.get(group)?.replaceChildren(changed ? `${changed} changed` : "");
    }
  }

  /** @param {Parameter[]} parameters */
  build(parameters) {
    this.knobs = new Map(parameters.map((parameter) => [parameter.name, new Knob(parameter, this.ask)]));
    this.lecture = parameters.filter(({ lecture }) => lecture).map((parameter) => new Knob(parameter, this.ask, true));
    this.dozen.replaceChildren(make("h2", { textContent: "For a lecture" }), ...this.lecture.map(({ box }) => box));
    this.search.placeholder = `Search all ${parameters.length}: name, symbol, meaning`;
    this.sizes = [];
    const drawn = [...grouped(parameters)].map(([group, members]) => {
      const changed = make("small", { className: "changed" });
      this.changed.set(group, changed);
      const size = make("small");
      this.sizes.push(size);
      const boxes = members.flatMap(({ name }) => this.knobs.get(name)?.box ?? []);
      return make("details", {}, make("summary", {}, make("span", { textContent: group }), changed, size), ...boxes);
    });
    this.groups.replaceChildren(...drawn);
    this.find();
    if (this.sought && document.activeElement === this.search) this.at(this.sought);
    this.sought = "";
  }

  /** Shows what the search finds, without the dozen, of which each is in its section; without a search, sections are open or closed as people left them. */
  find() {
    const search = this.search.value.trim();
    this.dozen.hidden = Boolean(search) || !this.lecture.length;
    let count = 0;
    for (const { parameter, box } of this.knobs.values()) {
      box.hidden = !means(parameter, search);
      count += Number(!box.hidden);
    }
    for (const [k, group] of this.groups.querySelectorAll("details").entries()) {
      const [all, found] = [".knob", ".knob:not([hidden])"].map((those) => group.querySelectorAll(those).length);
      group.hidden = found === 0;
      say(this.sizes[k], search ? `${found} of ${all}` : String(all));
      if (search) {
        group.dataset.was ??= String(group.open);
        group.open = true;
      } else if (group.dataset.was) {
        group.open = group.dataset.was === "true";
        delete group.dataset.was;
      }
    }
    const words = count === 1 ? "1 parameter" : `${count} parameters`;
    say(this.found, search && (count ? words : `nothing is called “${search}”`));
  }

  /** Shows one parameter alone, and puts the focus on it. @param {string} name */
  at(name) {
    this.search.value = name;
    this.find();
    const knob = this.knobs.get(name);
    if (!knob) this.sought = name;
    (knob?.input ?? this.search).focus();
  }

  /** @param {string} name */
  valueOf(name) {
    const value = this.knobs.get(name)?.parameter.value;
    return value === undefined ? null : String(value);
  }

  /** @param {Element} target */
  explain(target) {
    const box = target.closest(".knob");
    const knob = [...this.lecture, ...this.knobs.values()].find((one) => one.box === box);
    if (knob) say(this.hint, knob.parameter.hint);
  }

  get parts() {
    return { tune: this.tune.bind(this) };
  }
}

// One parameter as a control: its name, symbol and unit, its value, and a way back to the default.

import { icon, labelled, make } from "../ui/elements.js";
import { isDefault, printed, shortName } from "../model/knobs.js";

/** @typedef {import("../model/knobs.js").Parameter} Parameter */

let count = 0;

export class Knob {
  /** @param {Parameter} parameter @param {import("./panel.js").Ask} ask */
  constructor(parameter, ask) {
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
  if (symbol) {
    const [base, below] = printed(symbol);
    parts.push(make("i", {}, base, ...(below ? [make("sub", { textContent: below })] : [])));
  }
  if (unit) parts.push(make("small", { textContent: unit }));
  if (!live) parts.push(labelled("takes effect at reset", make("small", { textContent: "↻", role: "img" })));
  return make("span", { className: "words" }, ...parts.flatMap((part) => [part, " "]));
}

/** @param {Parameter} parameter */
function control({ value, choices, low, high, step }) {
  if (typeof value === "boolean") return make("input", { type: "checkbox" });
  if (choices.length) return make("select", {}, ...choices.map((choice) => new Option(choice)));
  if (typeof value === "string") return make("input", { type: "text", maxLength: 64, autocomplete: "off" });
  const limit = (/** @type {number | null} */ end) => (end === null ? "" : String(end));
  return make("input", { type: "number", min: limit(low), max: limit(high), step: String(step ?? "any") });
}

// The form beside the plan, with the properties of the selected thing.

import { field as target, find } from "../ui/elements.js";
import { length } from "../model/geometry.js";
import { kindOf, read, written } from "../model/things.js";

export class Fields {
  /**
   * @param {HTMLFormElement} form
   * @param {(item: any) => void} change when something was typed in
   * @param {() => void} remove for the button
   */
  constructor(form, change, remove) {
    this.form = form;
    this.change = change;
    /** @type {(Place & { item: any }) | null} */
    this.thing = null;
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("input", (event) => {
      target(event).dataset.typed = "yes";
    });
    form.addEventListener("change", (event) => this.changed(target(event)));
    find(form, ".remove").addEventListener("click", remove);
  }

  /** @param {(Place & { item: any }) | null} thing */
  show(thing) {
    this.form.hidden = !thing;
    const same = thing && this.thing?.list === thing.list && this.thing?.number === thing.number;
    this.thing = thing;
    if (!thing) return;
    const { one, fields } = kindOf(thing.list);
    const metres = thing.list === "walls" ? `, ${length(thing.item).toFixed(2)} m` : "";
    find(this.form, "h2").textContent = `${one[0].toUpperCase()}${one.slice(1)}${metres}`;
    const rows = find(this.form, ".rows");
    if (!same) rows.replaceChildren(...fields.map((field) => row(field)));
    for (const field of fields) {
      /** @type {HTMLInputElement} */
      const input = find(rows, `[data-key="${CSS.escape(field.key)}"]`);
      if (input.dataset.typed) continue; // somebody is typing here, and news of the office must not overwrite it
      const value = read(thing.item, field.key);
      if (field.type === "checkbox") input.checked = value ?? field.key !== "slides";
      else input.value = value ?? DEFAULTS[field.key] ?? "";
    }
  }

  /** @param {HTMLInputElement} input */
  changed(input) {
    delete input.dataset.typed;
    if (!this.thing) return;
    const field = kindOf(this.thing.list).fields.find(({ key }) => key === input.dataset.key);
    if (!field || !input.reportValidity()) return;
    const typed = field.type === "number" ? Number(input.value) : input.value;
    this.change(written(this.thing.item, field.key, field.type === "checkbox" ? input.checked : typed));
  }
}

/** @type {Record<string, string | number>} */
const DEFAULTS = { kind: "wall", swing_deg: 90, period_s: 0, open_s: 0, angle_deg: 0 };

/** @param {Field} field */
function row({ key, title, type, low, high, of }) {
  const input = document.createElement(of ? "select" : "input");
  input.dataset.key = key;
  if (input instanceof HTMLSelectElement) input.append(...(of ?? []).map((name) => new Option(name)));
  else input.type = type;
  if (type === "number") Object.assign(input, { min: low, max: high, step: "any", required: true });
  if (type === "text") Object.assign(input, { maxLength: 40, required: true, autocomplete: "off" });
  const label = document.createElement("label");
  label.append(Object.assign(document.createElement("span"), { textContent: title }), input);
  if (type === "checkbox") label.classList.add("flag");
  return label;
}

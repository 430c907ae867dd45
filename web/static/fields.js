// The form beside the plan: what can be typed in of the thing that is selected.

import { THINGS, length, read, written } from "./things.js";

export class Fields {
  // `change(item)` when something was typed in, `remove()` for the button.
  constructor(form, change, remove) {
    Object.assign(this, { form, change });
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("input", (event) => (event.target.dataset.typed = "yes"));
    form.addEventListener("change", (event) => this.changed(event.target));
    form.querySelector(".remove").addEventListener("click", remove);
  }

  // thing: {list, number, item} or null.
  show(thing) {
    this.form.hidden = !thing;
    const same = thing && this.thing?.list === thing.list && this.thing?.number === thing.number;
    this.thing = thing;
    if (!thing) return;
    const { one, fields } = THINGS[thing.list];
    const metres = thing.list === "walls" ? `, ${length(thing.item).toFixed(2)} m` : "";
    this.form.querySelector("h2").textContent = `${one[0].toUpperCase()}${one.slice(1)}${metres}`;
    const rows = this.form.querySelector(".rows");
    if (!same) rows.replaceChildren(...fields.map((field) => row(field)));
    for (const field of fields) {
      const input = rows.querySelector(`[data-key="${CSS.escape(field.key)}"]`);
      if (input.dataset.typed) continue; // somebody is typing here: news of the office must not wipe it out
      const value = read(thing.item, field.key);
      if (field.type === "checkbox") input.checked = value ?? (field.key !== "slides");
      else input.value = value ?? DEFAULTS[field.key] ?? "";
    }
  }

  changed(input) {
    delete input.dataset.typed;
    const field = THINGS[this.thing.list].fields.find(({ key }) => key === input.dataset.key);
    if (!field || !input.reportValidity()) return;
    const value = field.type === "checkbox" ? input.checked : field.type === "number" ? Number(input.value) : input.value;
    this.change(written(this.thing.item, field.key, value));
  }
}

const DEFAULTS = { kind: "wall", swing_deg: 90, period_s: 0, open_s: 0, angle_deg: 0 };

function row({ key, title, type, low, high, of }) {
  const input = document.createElement(of ? "select" : "input");
  input.dataset.key = key;
  if (of) input.append(...of.map((name) => new Option(name)));
  else input.type = type;
  if (type === "number") Object.assign(input, { min: low, max: high, step: "any", required: true });
  if (type === "text") Object.assign(input, { maxLength: 40, required: true, autocomplete: "off" });
  const label = document.createElement("label");
  label.append(Object.assign(document.createElement("span"), { textContent: title }), input);
  if (type === "checkbox") label.classList.add("flag");
  return label;
}

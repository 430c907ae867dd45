// Elements by their properties; what a person typed only ever becomes text.

import { icon } from "./icons.js";

export function make(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export function labelled(label, made) {
  made.setAttribute("aria-label", label);
  made.title = label;
  return made;
}

export const timeInput = (label, value) =>
  labelled(label, make("input", { type: "text", className: "when", value, required: true, autocomplete: "off", inputMode: "text", maxLength: 12 }));

export const levelInput = (label, value) =>
  labelled(label, make("input", { type: "number", className: "level", value, min: 0, max: 3, step: "any", required: true }));

export const removeButton = (label) => labelled(label, make("button", { type: "button", className: "bare remove" }, icon("close")));

export function mark(input, wrong) {
  if (wrong) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

// Draw a list anew; who was in it stays there, and what somebody is typing stays typed.
export function keepingPlace(list, form, draw) {
  const held = list.contains(document.activeElement) ? document.activeElement : null;
  const number = held?.closest("li").dataset.number;
  const [kind, typed, count] = [held?.classList.contains("remove") ? "remove" : held?.classList[0], held?.dataset.typed && held.value, list.children.length];
  draw();
  if (!held) return;
  const row = list.querySelector(`li[data-number="${number}"]`);
  const place = row?.querySelector(`.${kind}`) ?? (row ?? list.lastElementChild ?? form).querySelector(kind === "remove" ? ".remove, .when" : ".what, .when");
  if (typed && row && list.children.length === count) Object.assign(place, { value: typed }).dataset.typed = "yes";
  place?.focus();
}

// Makes elements from their properties. What a person has typed only ever becomes text.

import { icon } from "./icons.js";

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Partial<HTMLElementTagNameMap[K]>} [properties]
 * @param {(Node | string)[]} children
 */
export function make(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  Object.assign(made, /** @type {object} */ (properties));
  made.append(...children);
  return made;
}

/** @template {HTMLElement} T @param {string} label @param {T} made @returns {T} */
export function labelled(label, made) {
  made.setAttribute("aria-label", label);
  made.title = label;
  return made;
}

/** @param {string} label @param {string} value */
export const timeInput = (label, value) =>
  labelled(
    label,
    make("input", {
      type: "text",
      className: "when",
      value,
      required: true,
      autocomplete: "off",
      inputMode: "text",
      maxLength: 12,
    }),
  );

/** @param {string} label @param {number} value */
export const levelInput = (label, value) =>
  labelled(
    label,
    make("input", {
      type: "number",
      className: "level",
      value: String(value),
      min: "0",
      max: "3",
      step: "any",
      required: true,
    }),
  );

/** @param {string} label */
export const removeButton = (label) =>
  labelled(label, make("button", { type: "button", className: "bare remove" }, icon("close")));

/** @param {Element} input @param {boolean} wrong */
export function mark(input, wrong) {
  if (wrong) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/**
 * Draw a list anew. The focus stays where it was, and so does text that somebody is typing.
 * @param {HTMLElement} list
 * @param {HTMLElement} form gets the focus when the list is empty
 * @param {() => void} draw
 */
export function keepingPlace(list, form, draw) {
  const held = list.contains(document.activeElement) ? /** @type {HTMLInputElement} */ (document.activeElement) : null;
  const number = held?.closest("li")?.dataset.number;
  const kind = held?.classList.contains("remove") ? "remove" : held?.classList[0];
  const [typed, count] = [held?.dataset.typed && held.value, list.children.length];
  draw();
  if (!held) return;
  const row = list.querySelector(`li[data-number="${number}"]`);
  const near = row ?? list.lastElementChild ?? form;
  /** @type {HTMLInputElement | null} */
  const place =
    row?.querySelector(`.${kind}`) ?? near.querySelector(kind === "remove" ? ".remove, .when" : ".what, .when");
  if (typed && row && place && list.children.length === count) {
    place.value = typed;
    place.dataset.typed = "yes";
  }
  place?.focus();
}

// Finds the elements of a page and makes new ones, icons too. What a person has typed only ever becomes text.

/**
 * The element with this id. The type check knows which ids index.html has, and of what.
 * @template {keyof IndexIds} K
 * @param {K} id
 * @returns {IndexIds[K]}
 */
export const $ = (id) => /** @type {any} */ (document.getElementById(id));

/**
 * The element that a selector finds in a place where there is one.
 * @template {Element} [T=HTMLElement]
 * @param {ParentNode} place
 * @param {string} selector
 * @returns {T}
 */
export const find = (place, selector) => /** @type {any} */ (place.querySelector(selector));

/**
 * The field that an event is about.
 * @param {Event} event
 * @returns {HTMLInputElement}
 */
export const field = ({ target }) => /** @type {any} */ (target);

/**
 * The element matching a selector in which an event happened, if any.
 * @param {Event} event
 * @param {string} selector
 * @returns {HTMLElement | null}
 */
export const within = ({ target }, selector) =>
  target && "closest" in target ? /** @type {HTMLElement} */ (target).closest(selector) : null;

const SVG = "http://www.w3.org/2000/svg";

/**
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} name
 * @param {Record<string, string | number>} [attributes]
 * @param {(Node | string)[]} children
 */
export function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}

/** @param {string} name */
export function icon(name) {
  return svg("svg", { class: "icon", "aria-hidden": "true" }, svg("use", { href: `#i-${name}` }));
}

/** @param {Element} place @param {string} name */
export function setIcon(place, name) {
  const use = find(place, "use");
  if (use.getAttribute("href") !== `#i-${name}`) use.setAttribute("href", `#i-${name}`);
}

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

/** @param {string} label */
export const removeButton = (label) =>
  labelled(label, make("button", { type: "button", className: "bare remove" }, icon("close")));

/** Sets a text only when it differs, so that one being read or selected stays. @param {Node} place @param {string} text */
export function say(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

/**
 * Draw a part of the panel anew when its data has changed; a focused button keeps the focus.
 * @param {HTMLElement} box
 * @param {unknown} data
 * @param {() => Node[]} draw
 */
export function renew(box, data, draw) {
  const text = JSON.stringify(data);
  if (box.dataset.shown === text) return;
  box.dataset.shown = text;
  const held = box.contains(document.activeElement) ? /** @type {HTMLElement} */ (document.activeElement) : null;
  const key = held?.dataset.key;
  box.replaceChildren(...draw());
  if (key) /** @type {HTMLElement | null} */ (box.querySelector(`[data-key="${CSS.escape(key)}"]`))?.focus();
}

/** What this browser has kept; null: nothing, or it keeps nothing. @param {string} key */
export function kept(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Keeps it in this browser, if that keeps anything. @param {string} key @param {string} value */
export function keep(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // It is forgotten with the page.
  }
}

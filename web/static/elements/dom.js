// The page's elements.

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

// Menus that drop down: a click elsewhere closes them.

import { find } from "../elements/dom.js";

/** @type {NodeListOf<HTMLDetailsElement>} */
const menus = document.querySelectorAll("details.menu");

for (const menu of menus)
  window.addEventListener("click", ({ target }) => {
    if (!menu.contains(/** @type {Node} */ (target))) menu.open = false;
  });

/** @param {HTMLDetailsElement} menu */
export function closeMenu(menu) {
  menu.open = false;
  find(menu, "summary").focus();
}

// True when one was open.
export function closeOpenMenu() {
  const menu = [...menus].find(({ open }) => open);
  if (menu) closeMenu(menu);
  return menu !== undefined;
}

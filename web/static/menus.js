// Menus that drop down: a click elsewhere closes them.

for (const menu of document.querySelectorAll("details.menu"))
  window.addEventListener("click", ({ target }) => menu.contains(target) || (menu.open = false));

export function closeMenu(menu) {
  menu.open = false;
  menu.querySelector("summary").focus();
}

// True when one was open.
export function closeOpenMenu() {
  const menu = document.querySelector("details.menu[open]");
  if (menu) closeMenu(menu);
  return menu !== null;
}

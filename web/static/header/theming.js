// Light or dark. The choice is each viewer's own: the server shows this page the plates of its theme.

import { $ } from "../elements/dom.js";
import { setIcon } from "../elements/icons.js";
import { THEMES } from "../shared.js";

export class Theming {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.link = link;
    this.show(firstTheme());
  }

  /** @returns {Theme} */
  get name() {
    return document.documentElement.dataset.theme === "light" ? "light" : "dark";
  }

  /** @param {Theme} name */
  show(name) {
    document.documentElement.dataset.theme = name;
    setIcon($("theme"), name === "dark" ? "sun" : "moon");
    $("theme").setAttribute("aria-label", name === "dark" ? "Light colours" : "Dark colours");
    this.link.tell({ type: "theme", name });
  }

  toggle() {
    const other = this.name === "dark" ? "light" : "dark";
    this.show(other);
    try {
      localStorage.setItem("theme", other);
    } catch {
      // The choice is forgotten with the page.
    }
  }
}

/** The theme chosen earlier in this browser, else the system's. @returns {Theme} */
function firstTheme() {
  const preferred = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  try {
    const kept = localStorage.getItem("theme");
    return THEMES.find((name) => name === kept) ?? preferred;
  } catch {
    return preferred; // this browser stores nothing
  }
}

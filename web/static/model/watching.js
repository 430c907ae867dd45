// A page that only looks on (`/?watch`): what it may say, and which keys it has. The server refuses everything else. No DOM.

import { LOOKS } from "../shared.js";

/** Whether a message concerns the page alone. @param {string} kind */
export const isLook = (kind) => /** @type {readonly string[]} */ (LOOKS).includes(kind);

/** @type {ReadonlySet<import("./key_table.js").Act>} */
export const KEYS = new Set(["view1", "view2", "view3", "view4", "follow", "panel", "theme", "present", "escape"]);

const WATCHER = "watch-";

/** A page's own id, which nobody can guess. The server knows by it that a page only looks on. @param {boolean} watching */
export function newId(watching) {
  const bytes = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0"));
  return (watching ? WATCHER : "") + bytes.join("");
}

/** @param {string} page */
export const looksOn = (page) => page.startsWith(WATCHER);

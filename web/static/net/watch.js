// `/?watch`: the page for a second screen. It shows what the main page shows and steers nothing; what steers is hidden or disabled
// here, and refused by the server.

import { LOOKS } from "../shared.js";
import { $ } from "../ui/elements.js";

/** Whether a message concerns the page alone. @param {string} kind */
export const isLook = (kind) => /** @type {readonly string[]} */ (LOOKS).includes(kind);

/** @type {ReadonlySet<import("../ui/keys.js").Act>} */
export const KEYS = new Set(["view1", "view2", "view3", "view4", "follow", "panel", "theme", "present", "escape"]);

const WATCHER = "watch-";

/** A page's own id, which nobody can guess. The server knows by it that a page only looks on. @param {boolean} watching */
export function newId(watching) {
  const bytes = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0"));
  return (watching ? WATCHER : "") + bytes.join("");
}

/** @param {string} page */
export const looksOn = (page) => page.startsWith(WATCHER);

/** Makes this page one that only looks on. @param {string} page its id */
export function onlyLook(page) {
  document.title = "RatSLAM, to watch";
  $("world").disabled = true;
  $("timeline").setAttribute("aria-readonly", "true");
  takeNoFiles(window);
  const plain = window.fetch.bind(window);
  window.fetch = (what, how = {}) => plain(what, { ...how, headers: { ...how.headers, "X-Page": page } });
}

/** What is dropped here is neither opened nor shown instead of the page. @param {Window} place */
export function takeNoFiles(place) {
  for (const kind of /** @type {const} */ (["dragenter", "dragover", "drop"]))
    place.addEventListener(
      kind,
      (event) => {
        event.preventDefault();
        event.stopImmediatePropagation();
        if (event.dataTransfer) event.dataTransfer.dropEffect = "none";
      },
      true,
    );
}

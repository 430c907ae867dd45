// `/?watch`: the page for a second screen. It shows what the main page shows and steers nothing; what steers is hidden or disabled
// here, and refused by the server.

import { $ } from "../elements/dom.js";
import { newId } from "../model/watching.js";

export const watching = document.body.dataset.watch === "true";
export const page = newId(watching);

if (watching) {
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

// The marks of events, as elements.

import { kinds, markOf, nameOf } from "../model/event_kinds.js";
import { svg } from "../ui/elements.js";

/** @param {string} kind @param {number} x @param {number} y */
export function markAt(kind, x, y) {
  const { d, open } = markOf(kind);
  return svg("path", { d, transform: `translate(${x} ${y})`, class: open ? "mark open" : "mark", "data-kind": kind });
}

// What the marks mean, for the help.
export function legend() {
  return kinds.map((kind) => {
    const item = document.createElement("li");
    item.append(
      svg("svg", { viewBox: "-10 -10 20 20", class: "icon", "aria-hidden": "true" }, markAt(kind, 0, 0)),
      nameOf(kind),
    );
    return item;
  });
}

// Activity by heading: bars on a common floor, 0° to 360°.

import { make, svg } from "../ui/elements.js";
import { bars } from "../model/pixels.js";

export class Histogram {
  /** @param {string} words */
  constructor(words) {
    this.path = svg("path", {});
    this.drawing = svg(
      "svg",
      { role: "img", "aria-label": words, preserveAspectRatio: "none", class: "bars" },
      this.path,
    );
    const ticks = ["0°", "180°", "360°"].map((tick) => make("span", { textContent: tick }));
    this.box = make("div", { className: "histogram" }, this.drawing, make("div", { className: "ticks" }, ...ticks));
  }

  /** @param {ArrayLike<number>} values */
  show(values) {
    this.drawing.setAttribute("viewBox", `0 0 ${values.length} 100`);
    this.path.setAttribute("d", bars(values));
  }
}

// A form that injects a packet by hand at the chosen column of pose cells, to watch how it competes with the others.

import { make } from "../ui/elements.js";
import { note } from "./parts.js";

export class InjectForm {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    const heading = slider("heading θ′", "°", 0, 350, 10, 0);
    const share = slider("share of all activity", "%", 5, 90, 5, 45);
    const button = make("button", { type: "submit", textContent: "Inject" });
    this.title = make("h2", { textContent: "Inject a packet here" });
    this.box = make(
      "form",
      { hidden: true, className: "inject" },
      this.title,
      note("No sense says it: watch how it competes with the others."),
      heading.box,
      share.box,
      button,
    );
    /** @type {{ x: number, y: number } | null} */
    this.cell = null;
    this.box.addEventListener("submit", (event) => {
      event.preventDefault();
      if (!this.cell) return;
      const turn = { heading_rad: (heading.value() * Math.PI) / 180, share: share.value() / 100 };
      ask({ type: "inject_packet", x: this.cell.x, y: this.cell.y, ...turn });
    });
  }

  /** @param {{ x: number, y: number } | null} cell */
  show(cell) {
    this.cell = cell;
    this.box.hidden = cell === null;
  }
}

/**
 * @param {string} words @param {string} unit @param {number} low @param {number} high @param {number} step @param {number} value
 */
function slider(words, unit, low, high, step, value) {
  const input = make("input", { type: "range", min: `${low}`, max: `${high}`, step: `${step}`, value: `${value}` });
  const shown = make("output");
  const tell = () => {
    shown.value = `${input.value} ${unit}`.replace(" °", "°");
    input.setAttribute("aria-valuetext", shown.value);
  };
  input.addEventListener("input", tell);
  tell();
  const box = make("label", { className: "slider" }, make("span", { textContent: words }), shown, input);
  return { box, value: () => Number(input.value) };
}

// Inspect: one experience, view or column of pose cells, chosen on the plates, by number or by what is active now; a packet can be
// injected by hand at the chosen column.

import { make, renew } from "../ui/elements.js";
import { nameOf } from "../timeline/events.js";
import { choice, heading, note, SwitchList } from "./parts.js";
import { Report } from "./report.js";

const NOTHING =
  "Nothing is chosen. Hold shift and click on the map, or touch it with Click inspects on: the experience there is shown, with " +
  "all that the robot knows of it. " +
  "Click into the pose cells: what is active there, and which views lead there.";

export class InspectTab {
  /** @param {import("./panel.js").Ask} ask @param {(text: string) => void} complain */
  constructor(ask, complain) {
    this.ask = ask;
    this.complain = complain;
    this.switches = new SwitchList("Inspect", ask);
    this.active = { experience: -1, view: -1 };
    this.experience = this.number("experience");
    this.view = this.number("view");
    this.nothing = note(NOTHING);
    this.report = new Report((wish) => this.look(wish), ask);
    this.inject = new InjectForm(ask);
    this.buttons = ["experience", "view", "nothing"].map((kind) => this.button(kind));
    const now = make("div", { className: "buttons" }, ...this.buttons);
    now.setAttribute("role", "group");
    now.setAttribute("aria-label", "Look at what is active now");
    this.events = make("div", { className: "choices" });
    const numbers = make("div", { className: "pair" }, this.experience.label, this.view.label);
    const choose = make("div", { className: "choose" }, make("span", { textContent: "active now" }), now);
    this.box = make(
      "div",
      {},
      this.switches.box,
      choose,
      numbers,
      this.events,
      this.nothing,
      this.report.box,
      this.inject.box,
    );
  }

  /** @param {Record<string, number>} wish by the fields of `inspect` */
  look(wish) {
    this.ask({ type: "inspect", ...wish });
  }

  /** @param {string} kind */
  number(kind) {
    const input = make("input", { type: "number", min: "0", step: "1", value: "0" });
    input.addEventListener("change", () => input.value !== "" && this.look({ [kind]: Number(input.value) }));
    const label = make("label", { className: "knob" }, make("span", { textContent: `${kind} #` }), input);
    label.title = `Look at the ${kind} of this number.`;
    return { input, label };
  }

  /** What is active is known a moment after the tab has opened. @param {string} kind */
  button(kind) {
    const button = make("button", { type: "button", textContent: kind, disabled: kind !== "nothing" });
    button.addEventListener("click", () => {
      const number = kind === "view" ? this.active.view : this.active.experience;
      if (kind === "nothing") this.look({});
      else if (number >= 0) this.look({ [kind]: number });
      else this.complain(`Nothing to inspect: there is no ${kind} yet.`);
    });
    return button;
  }

  /** Why something has happened, of what happened of late. @param {[number, string, string][]} events */
  why(events) {
    const buttons = events.map(([number, kind, at]) =>
      choice("event", number, `${nameOf(kind)} ${at}`, (w) => this.look(w)),
    );
    return events.length ? [heading("Why did it happen?"), ...buttons] : [];
  }

  /** @param {any} data @param {import("./senses.js").Arrays} arrays */
  inspected(data, arrays) {
    this.nothing.hidden = data.kind !== null;
    this.report.show(data, arrays);
    this.inject.show(data.kind === "cell" ? data : null);
    const field = data.kind === "experience" ? this.experience : data.kind === "view" ? this.view : null;
    if (field && document.activeElement !== field.input) field.input.value = String(data.id);
  }

  get parts() {
    return {
      switches: this.switches.show.bind(this.switches),
      /** @param {{ experience: number, view: number, events: [number, string, string][] }} data */
      active: (data) => {
        this.active = data;
        for (const button of this.buttons) button.disabled = false;
        renew(this.events, data.events, () => this.why(data.events));
      },
      inspected: this.inspected.bind(this),
    };
  }
}

/** Injects a packet by hand at the chosen column, to watch how it competes with the others. */
class InjectForm {
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

// The report on one experience, one view or one column of pose cells.

import { make, renew, say } from "../ui/elements.js";
import { Picture } from "./canvases.js";
import { Histogram } from "./histogram.js";
import { Why } from "./why.js";
import { caption, choice, heading, note, Table } from "./parts.js";

const TITLES = { experience: "experience", view: "local view cell", cell: "pose cells at", why: "why, at" };

/**
 * @typedef {{ title: string, kind: string, entries: [number, string][], more: number, empty: string }} Choices
 * @typedef {{ title: string, more: number, rows: { word: string, experience: number, way: string, known: string }[] }} Links
 * @typedef {[string, string][]} Chain when and what, in order
 * @typedef {{ table?: import("./parts.js").TableData, choices?: Choices, links?: Links, chain?: Chain }} Section
 */

export class Report {
  /** @param {(wish: Record<string, number>) => void} inspect @param {import("./panel.js").Ask} ask */
  constructor(inspect, ask) {
    this.inspect = inspect;
    this.title = caption("");
    this.name = make("p", { className: "number" });
    this.words = make("p");
    this.picture = new Picture("the stored view");
    this.now = new Picture("what the robot makes of it");
    this.camera = new Picture("what the robot's camera sees now");
    this.noCamera = make("p", { className: "blank", textContent: "no camera, or it is off", hidden: true });
    this.turns = new Histogram("activity by heading");
    this.aside = make("div");
    this.pair = make("div", { className: "pair" });
    this.sections = make("div");
    this.why = new Why(inspect, ask);
    const head = make("div", { className: "pair" }, make("div", {}, this.title, this.name, this.words), this.aside);
    this.box = make("div", { hidden: true }, head, this.pair, this.sections, this.why.box);
    this.kind = null;
    /** @type {(HTMLElement | Table)[]} */
    this.drawn = [];
  }

  /** @param {any} data @param {import("./senses.js").Arrays} arrays */
  show(data, arrays) {
    this.box.hidden = data.kind === null;
    if (data.kind === null) return;
    say(this.title, TITLES[/** @type {keyof typeof TITLES} */ (data.kind)]);
    say(this.name, data.number);
    say(this.words, data.words);
    this.showPictures(data, arrays);
    this.why.box.hidden = data.kind !== "why";
    if (data.kind === "why") this.why.show(data, arrays);
    const shape = data.sections.map((/** @type {Section} */ section) => Object.keys(section)[0]).join();
    if (this.sections.dataset.shape !== shape) this.build(data.sections, shape);
    for (const [k, section] of data.sections.entries()) this.fill(section, this.drawn[k]);
  }

  /** @param {any} data @param {import("./senses.js").Arrays} arrays */
  showPictures(data, arrays) {
    renew(this.aside, [data.kind, data.view, "picture" in arrays], () => this.beside(data, "picture" in arrays));
    renew(this.pair, data.kind, () => {
      if (data.kind !== "view") return [];
      const [stored, now] = [this.picture.canvas, this.now.canvas];
      return [make("div", {}, caption("as it is stored"), stored), make("div", {}, caption("what is made of it"), now)];
    });
    this.picture.says(`the stored view ${data.kind === "view" ? data.id : data.view}`).show(arrays.picture);
    this.now.show(arrays.now);
    this.camera.show(arrays.camera);
    this.noCamera.hidden = !this.camera.canvas.hidden;
    if (arrays.by_heading) this.turns.show(arrays.by_heading.values);
    if (data.kind === "cell") this.turns.box.hidden = !this.turns.path.getAttribute("d");
  }

  /** @param {any} data @param {boolean} seen */
  beside(data, seen) {
    if (data.kind === "view") return [caption("camera now"), this.camera.canvas, this.noCamera];
    if (data.kind === "why") return [caption("camera then"), this.camera.canvas, this.noCamera];
    if (data.kind === "cell") return [caption("by heading θ′"), this.turns.box];
    if (!seen)
      return [caption("view"), make("p", { className: "blank", textContent: "made where there was nothing to see" })];
    const button = make("button", { type: "button", className: "picture" }, this.picture.canvas);
    button.setAttribute("aria-label", `Inspect its view ${data.view}`);
    button.dataset.key = "its view";
    button.addEventListener("click", () => this.inspect({ view: data.view }));
    return [caption(`its view #${data.view}`), button];
  }

  /** @param {Section[]} sections @param {string} shape */
  build(sections, shape) {
    this.sections.dataset.shape = shape;
    this.drawn = sections.map((section) => (section.table ? new Table() : make("section")));
    this.sections.replaceChildren(...this.drawn.map((drawn) => (drawn instanceof Table ? drawn.box : drawn)));
  }

  /** @param {Section} section @param {HTMLElement | Table} drawn */
  fill({ table, choices, links, chain }, drawn) {
    if (drawn instanceof Table) {
      if (table) drawn.show(table);
    } else if (choices) renew(drawn, choices, () => this.choices(choices));
    else if (links) renew(drawn, links, () => this.links(links));
    else if (chain) renew(drawn, chain, () => this.chain(chain));
  }

  /** @param {Choices} choices */
  choices({ title, kind, entries, more, empty }) {
    if (entries.length === 0) return [heading(title), note(empty)];
    const buttons = entries.map(([number, word]) => choice(kind, number, `#${number} ${word}`.trim(), this.inspect));
    const left = more > 0 ? [make("span", { className: "quiet", textContent: `and ${more} more` })] : [];
    return [heading(title), make("div", { className: "choices" }, ...buttons, ...left)];
  }

  /** @param {Chain} chain */
  chain(chain) {
    const steps = chain.map(([at, words]) => make("li", {}, make("time", { textContent: at }), ` ${words}`));
    return [heading("What led to it"), make("ol", { className: "chain" }, ...steps)];
  }

  /** @param {Links} links */
  links({ title, rows, more }) {
    const list = rows.map(({ word, experience, way, known }) => {
      const to = choice("experience", experience, `${word} #${experience}`, this.inspect);
      to.dataset.key = `${word} ${experience}`;
      const head = make("span", { className: "way", textContent: way });
      return make("li", {}, to, head, make("span", { className: "quiet", textContent: known }));
    });
    const left = more > 0 ? [note(`and ${more} more`)] : [];
    return [heading(title), make("ul", { className: "links" }, ...list), ...left];
  }
}

// Senses: the camera's image, the stored view most like it, how different they are, and which cells are active.

import { make, say } from "../ui/elements.js";
import { fromAbove } from "../model/pixels.js";
import { colourOf, Picture } from "./canvases.js";
import { Histogram } from "./histogram.js";
import { Bar, caption } from "./parts.js";
import { ViewStrip } from "./view_strip.js";

const PACKETS = ["packet-1", "packet-2", "packet-3", "packet-4"];

/** @typedef {Record<string, import("../net/connection.js").Parcel>} Arrays */

export class SensesTab {
  /** @param {(wish: Record<string, number>) => void} inspect */
  constructor(inspect) {
    this.camera = new Picture("what the robot's camera sees");
    this.seen = new Picture("the present view, as it is compared");
    this.best = new Picture("the best match");
    this.above = new Picture("pose cells seen from above, x′ to the right");
    this.seenTitle = caption("");
    this.bestTitle = caption("best match");
    this.difference = caption("");
    this.cells = caption("");
    this.number = make("p", { className: "number" });
    this.words = make("span");
    this.verdict = make("p", { className: "verdict" }, make("i"), this.words);
    this.view = -1;
    this.match = make("button", { type: "button", className: "picture", hidden: true }, this.best.canvas);
    this.match.addEventListener("click", () => inspect({ view: this.view }));
    this.none = make("p", { className: "blank", textContent: "none yet: every view is new" });
    this.noCamera = make("p", { className: "blank", textContent: "no camera, or it is off", hidden: true });
    this.bar = new Bar(0.5);
    this.strip = new ViewStrip(inspect);
    this.turns = new Histogram("activity by heading");
    this.box = make(
      "div",
      {},
      row([caption("camera"), this.camera.canvas, this.noCamera], [caption("active view"), this.number, this.verdict]),
      row([this.seenTitle, this.seen.canvas], [this.bestTitle, this.match, this.none]),
      this.difference,
      this.bar.box,
      this.cells,
      this.strip.box,
      row([caption("pose cells from above"), this.above.canvas], [caption("by heading θ′"), this.turns.box]),
    );
  }

  /** @param {any} data @param {Arrays} arrays */
  views(data, arrays) {
    this.camera.show(arrays.camera);
    this.noCamera.hidden = !this.camera.canvas.hidden;
    say(this.number, data.active >= 0 ? `#${data.active}` : "none");
    say(this.words, data.verdict.words);
    this.verdict.dataset.tone = data.verdict.tone;
    say(this.seenTitle, data.seen.title);
    this.seen.says(data.seen.words).show(arrays.seen);
    this.match.hidden = data.best === null;
    this.none.hidden = data.best !== null;
    say(this.bestTitle, data.best ? `best match #${data.best.view}` : "best match");
    if (data.best) {
      this.view = data.best.view;
      this.match.setAttribute("aria-label", `Inspect ${data.best.words}`);
      this.best.says(data.best.words).show(arrays.best);
    }
    const { active, known, recent } = data;
    say(this.cells, `local view cells (${active >= 0 ? `active #${active}` : "none active"} of ${known})`);
    this.strip.show({ active, views: known, recent });
    say(this.difference, data.difference.words);
    this.bar.show(data.difference.share, data.difference.known ? "known" : "new");
  }

  /** @param {any} data @param {Arrays} arrays */
  poseCells(data, arrays) {
    const [places, packets, strength] = [arrays.places, arrays.packets, arrays.strength].map(({ values }) => values);
    this.above.draw(fromAbove(data.size, places, packets, strength, PACKETS.map(colourOf), colourOf("second")));
    this.turns.show(arrays.by_heading.values);
  }

  /** What to do with each part, by its name. */
  get parts() {
    return { views: this.views.bind(this), cells: this.poseCells.bind(this) };
  }
}

/** Two columns of equal width. @param {Node[]} left @param {Node[]} right */
function row(left, right) {
  return make("div", { className: "pair" }, make("div", {}, ...left), make("div", {}, ...right));
}

// The report on one experience, one view, one column of pose cells, or on why something happened: the chain of what led to it,
// the packets before and after, and the views that played a part.

import { make, renew, say, svg } from "../ui/elements.js";
import { caption, choice, heading, Histogram, note, Picture, Table } from "./parts.js";

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

const MOST_VIEWS = 4;

/** @typedef {[number, number, number, number]} Packet number, x, y (cells), share of the activity */
/** @typedef {{ id: number, without: number[], event: string, number: string, cells: [number, number], packets: [Packet[], Packet[]], seen: [number, string][], said: [number, number][] }} Told */

/** Why something happened: the chain of what led to it, the packets before and after, and the views that played a part. */
class Why {
  /** @param {(wish: Record<string, number>) => void} inspect @param {import("./panel.js").Ask} ask */
  constructor(inspect, ask) {
    this.inspect = inspect;
    this.ask = ask;
    this.without = make("div", { className: "without" });
    this.packets = make("div", { className: "pair" });
    this.said = make("div");
    this.views = make("div", { className: "seen" });
    this.pictures = Array.from({ length: MOST_VIEWS }, () => new Picture("a view"));
    this.box = make(
      "div",
      { hidden: true },
      this.said,
      heading("Packets, from above"),
      this.packets,
      this.views,
      this.without,
    );
  }

  /** @param {Told} told @param {import("./senses.js").Arrays} arrays */
  show(told, arrays) {
    renew(this.said, told.said, () =>
      told.said.length ? [heading("What spoke for this place, and against it"), bars(told.said)] : [],
    );
    renew(this.packets, told.packets, () =>
      told.packets.map((packets, k) => {
        const words = k === 0 ? "the tick before" : "then";
        return make("div", {}, caption(words), fromAbove(packets, told.cells, words));
      }),
    );
    renew(this.views, [told.number, told.seen], () => (told.seen.length ? this.seen(told.seen) : []));
    renew(this.without, [told.id, told.without], () => (told.without.length ? this.goOn(told) : []));
    for (const [k, [view]] of told.seen.entries())
      this.pictures[k].says(`the stored view ${view}`).show(arrays[`seen${k}`]);
  }

  /** @param {Told} told */
  goOn({ id, without }) {
    const words = without.length === 1 ? "this view" : "these views";
    const button = make("button", { type: "button", textContent: `Go on without ${words}` });
    button.dataset.key = "without";
    button.addEventListener("click", () => this.ask({ type: "go_on_without", event: id }));
    const told = `Back to before it, in a branch whose brain has forgotten ${words}. The run as it was stays.`;
    return [heading("What if not?"), note(told), button];
  }

  /** @param {[number, string][]} seen */
  seen(seen) {
    const cards = seen.map(([view, words], k) => {
      const button = choice("view", view, `#${view}`, this.inspect);
      return make("figure", {}, this.pictures[k].canvas, make("figcaption", {}, button, ` ${words}`));
    });
    return [heading("Views that played a part"), ...cards];
  }
}

/** What was said of a place, part by part: upwards for it, downwards against it. @param {[number, number][]} said s, nats */
function bars(said) {
  const [wide, high] = [100, 34];
  const most = Math.max(1, ...said.map(([, nats]) => Math.abs(nats)));
  const each = wide / said.length;
  const drawn = said.map(([, nats], k) => {
    const tall = (Math.abs(nats) / most) * (high / 2 - 5);
    const at = { x: k * each + 0.1 * each, y: nats > 0 ? high / 2 - tall : high / 2, width: 0.8 * each, height: tall };
    return svg("rect", { ...at, class: nats > 0 ? "for" : "against" });
  });
  const sum = said.reduce((all, [, nats]) => all + nats, 0);
  const [first, last] = [said[0][0], said[said.length - 1][0]];
  const words = `${said.length} parts from ${first} to ${last} s, ${sum.toFixed(1)} nats in all`;
  return svg(
    "svg",
    { viewBox: `0 0 ${wide} ${high}`, role: "img", class: "spoken", "aria-label": words },
    svg("path", { d: `M0 ${high / 2}h${wide}`, class: "zero" }),
    ...drawn,
    svg("text", { x: 0, y: high - 0.6 }, `${first} s`),
    svg("text", { x: wide, y: high - 0.6, "text-anchor": "end" }, `${last} s`),
    svg("text", { x: 0, y: 3.6 }, `highest bar ${most.toFixed(1)} nats; ${sum.toFixed(1)} in all`),
  );
}

/** Packets as discs on the floor of the pose cells; the area is the share of the activity. */
function fromAbove(/** @type {Packet[]} */ packets, /** @type {[number, number]} */ [height, width], words = "") {
  const discs = packets.map(([id, x, y, mass]) => {
    const r = Math.max(1.2, 0.22 * width * Math.sqrt(mass));
    const at = { cx: x, cy: height - y };
    return svg(
      "g",
      {},
      svg("circle", { ...at, r, class: "disc" }),
      svg(
        "text",
        { x: at.cx, y: at.cy, "font-size": width / 11, class: "share" },
        `${id}: ${Math.round(100 * mass)} %`,
      ),
    );
  });
  const label = packets.map(([id, x, y, mass]) => `packet ${id} ${Math.round(100 * mass)} % at ${x}, ${y}`).join("; ");
  return svg(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, role: "img", class: "from-above", "aria-label": `${words}: ${label}` },
    ...discs,
  );
}

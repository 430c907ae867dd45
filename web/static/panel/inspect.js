// Inspect: one experience, view or column of pose cells, chosen on the plates, by number or by what is active now; a packet can be
// injected by hand at the chosen column.

import { make, renew, say, svg } from "../ui/elements.js";
import { likelier } from "../ui/words.js";
import { nameOf } from "../timeline/events.js";
import { choice, heading, note, SwitchList, caption, Histogram, Picture, Table } from "./parts.js";

const NOTHING =
  "Shift-click the map (or touch it with Click inspects on): the experience there. " +
  "Click the pose cells: what is active there, and which views lead there.";

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
      note("No view speaks for it: watch it compete."),
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
  const update = () => {
    shown.value = `${input.value} ${unit}`.replace(" °", "°");
    input.setAttribute("aria-valuetext", shown.value);
  };
  input.addEventListener("input", update);
  update();
  const box = make("label", { className: "slider" }, make("span", { textContent: words }), shown, input);
  return { box, value: () => Number(input.value) };
}

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
    if (!seen) return [caption("view"), make("p", { className: "blank", textContent: "nothing was seen here" })];
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
/** @typedef {{ id: number, without: number[], event: string, number: string, cells: [number, number], packets: [Packet[], Packet[]], seen: [number, string][], said: [number, number][] }} WhyReport */

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

  /** @param {WhyReport} report @param {import("./senses.js").Arrays} arrays */
  show(report, arrays) {
    renew(this.said, report.said, () =>
      report.said.length ? [heading("Evidence for and against this place"), bars(report.said)] : [],
    );
    renew(this.packets, report.packets, () =>
      report.packets.map((packets, k) => {
        const words = k === 0 ? "the tick before" : "then";
        return make("div", {}, caption(words), fromAbove(packets, report.cells, words));
      }),
    );
    renew(this.views, [report.number, report.seen], () => (report.seen.length ? this.seen(report.seen) : []));
    renew(this.without, [report.id, report.without], () => (report.without.length ? this.goOn(report) : []));
    for (const [k, [view]] of report.seen.entries())
      this.pictures[k].says(`the stored view ${view}`).show(arrays[`seen${k}`]);
  }

  /** @param {WhyReport} report */
  goOn({ id, without }) {
    const words = without.length === 1 ? "this view" : "these views";
    const button = make("button", { type: "button", textContent: `Go on without ${words}` });
    button.dataset.key = "without";
    button.addEventListener("click", () => this.ask({ type: "go_on_without", event: id }));
    const hint = `Back to before it, in a branch whose brain has forgotten ${words}. The run as it was stays.`;
    return [heading("What if not?"), note(hint), button];
  }

  /** @param {[number, string][]} seen */
  seen(seen) {
    const cards = seen.map(([view, words], k) => {
      const button = choice("view", view, `#${view}`, this.inspect);
      return make("figure", {}, this.pictures[k].canvas, make("figcaption", {}, button, ` ${words}`));
    });
    return [heading("Views involved"), ...cards];
  }
}

/** What was said of a place, part by part: upwards for it, downwards against it. @param {[number, number][]} said s, nats */
function bars(said) {
  const [wide, high] = [100, 34];
  const longest = said.map(([, nats]) => nats).reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a));
  const most = Math.max(1, Math.abs(longest)); // the scale: little said is drawn small
  const each = wide / said.length;
  const drawn = said.map(([, nats], k) => {
    const tall = (Math.abs(nats) / most) * (high / 2 - 5);
    const at = { x: k * each + 0.1 * each, y: nats > 0 ? high / 2 - tall : high / 2, width: 0.8 * each, height: tall };
    return svg("rect", { ...at, class: nats > 0 ? "for" : "against" });
  });
  const sum = said.reduce((all, [, nats]) => all + nats, 0);
  const [first, last] = [said[0][0], said[said.length - 1][0]];
  const words = `${likelier(sum)} in all, from ${first} to ${last} s; the longest bar: ${likelier(longest)}`;
  return svg(
    "svg",
    { viewBox: `0 0 ${wide} ${high}`, role: "img", class: "spoken", "aria-label": words },
    svg("path", { d: `M0 ${high / 2}h${wide}`, class: "zero" }),
    ...drawn,
    svg("text", { x: 0, y: high - 0.6 }, `${first} s`),
    svg("text", { x: wide, y: high - 0.6, "text-anchor": "end" }, `${last} s`),
    svg("text", { x: 0, y: 3.6 }, `${likelier(sum)} in all; the longest bar: ${likelier(longest)}`),
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
        { x: Math.min(0.82 * width, Math.max(0.18 * width, at.cx)), y: at.cy, "font-size": width / 11, class: "share" },
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

// Why something happened: the chain of what led to it, the packets before and after, and the views that played a part.

import { make, renew, svg } from "../ui/elements.js";
import { Picture } from "./canvases.js";
import { caption, choice, heading, note } from "./parts.js";

const MOST_VIEWS = 4;

/** @typedef {[number, number, number, number]} Packet number, x, y (cells), share of the activity */
/** @typedef {{ id: number, without: number[], event: string, number: string, cells: [number, number], packets: [Packet[], Packet[]], seen: [number, string][], said: [number, number][] }} Told */

export class Why {
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

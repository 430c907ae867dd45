// A plot against the session's time, drawn by uPlot, which is fetched when the first plot is made.

import { make } from "../ui/elements.js";
import { saveButtons } from "../share/pictures.js";

/** @typedef {{ label: string, colour: string, digits: number, dash?: number[] }} Line `colour`: a custom property of the page */

const property = (/** @type {string} */ name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export class Plot {
  /** @param {string} words @param {Line[]} lines @param {number} height */
  constructor(words, lines, height) {
    this.lines = lines;
    this.height = height;
    this.box = make("div", { className: "plot" });
    this.box.append(saveButtons(words, () => ({ columns: this.data, lines })));
    this.box.setAttribute("role", "group");
    this.box.setAttribute("aria-label", words);
    /** @type {import("../vendor/uplot/uPlot.esm.js").default | null} */
    this.plot = null;
    /** @type {ArrayLike<number>[] | null} */
    this.data = null;
    new ResizeObserver(() => this.fit()).observe(this.box);
  }

  /** @param {ArrayLike<number>[]} columns the time first */
  async show(columns) {
    this.data = columns;
    if (this.plot) {
      this.plot.setData(columns);
      return this.tellNewest();
    }
    await this.build();
  }

  /** Draws the plot anew, in the colours of the theme. */
  async build() {
    const { default: uPlot } = await import("../vendor/uplot/uPlot.esm.js");
    this.plot?.destroy();
    this.plot = null;
    if (!this.data || this.box.clientWidth === 0) return; // the tab has been left meanwhile
    const grid = { stroke: property("rim"), width: 1 };
    const axis = { stroke: property("second"), grid, ticks: grid, font: "12px system-ui, sans-serif" };
    const series = this.lines.map(({ label, colour, digits, dash }) => {
      const value = (/** @type {unknown} */ _, /** @type {number | null} */ shown) => shown?.toFixed(digits) ?? "-";
      return { label, stroke: property(colour), width: 2, dash, value };
    });
    const options = {
      width: this.box.clientWidth,
      height: this.height,
      scales: { x: { time: false } }, // seconds, not dates
      axes: [axis, { ...axis, size: 50 }],
      series: [
        {
          label: "time (s)",
          value: (/** @type {unknown} */ _, /** @type {number | null} */ s) => s?.toFixed(0) ?? "-",
        },
        ...series,
      ],
      cursor: { drag: { x: false, y: false } },
    };
    this.plot = new uPlot(options, this.data, this.box);
    this.tellNewest();
    const canvas = this.box.querySelector("canvas");
    canvas?.setAttribute("role", "img");
    canvas?.setAttribute("aria-label", this.box.getAttribute("aria-label") ?? "");
  }

  /** Shows the newest values in the legend while nobody points at others. */
  tellNewest() {
    if (this.plot && this.plot.cursor.idx == null) this.plot.setLegend({ idx: this.plot.data[0].length - 1 });
  }

  fit() {
    const width = this.box.clientWidth;
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.height });
    else if (!this.plot && this.data && width > 0) this.build();
  }
}

// Truth: how far map and odometry are from the robot's true place, and how far the map is from its own links, as plots against
// the session's time.

import { make, say } from "../ui/elements.js";
import { saveButtons } from "../share/pictures.js";
import { heading, note, SwitchList, Table } from "./parts.js";

/** @typedef {{ label: string, colour: string, digits: number, dash?: number[] }} Line `colour`: a custom property of the page */

const property = (/** @type {string} */ name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A plot drawn by uPlot, which is fetched when the first one is made. */
class Plot {
  /**
   * `most`: where the scale ends that else fits the values.
   * @param {string} words @param {Line[]} lines @param {number} height @param {number | null} most
   */
  constructor(words, lines, height, most = null) {
    this.lines = lines;
    this.height = height;
    this.most = most;
    this.box = make("div", { className: "plot" });
    this.box.append(saveButtons(words, () => ({ columns: this.data, lines })));
    this.box.setAttribute("role", "group");
    this.box.setAttribute("aria-label", words);
    /** @type {import("../vendor/uPlot.esm.js").default | null} */
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
    const { default: uPlot } = await import("../vendor/uPlot.esm.js");
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
      scales: { x: { time: false }, y: this.most === null ? {} : { range: [0, this.most] } }, // seconds, not dates
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

const DASH = [6, 4];

export class TruthTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.switches = new SwitchList("Truth", ask);
    this.table = new Table();
    this.errors = new Plot(
      "Errors against time",
      [
        { label: "map (m)", digits: 2, colour: "packet-2" },
        { label: "odometry (m)", digits: 2, colour: "robot", dash: DASH },
      ],
      170,
    );
    this.explored = new Plot(
      "Explored floor against time",
      [{ label: "explored (%)", digits: 0, colour: "packet-2" }],
      150,
      100,
    );
    this.counts = new Plot(
      "Views and experiences against time",
      [
        { label: "views", digits: 0, colour: "packet-1" },
        { label: "experiences", digits: 0, colour: "packet-2", dash: DASH },
      ],
      150,
    );
    this.residual = new Plot(
      "Residual of the map correction against time",
      [
        { label: "distance (mm)", digits: 1, colour: "packet-2" },
        { label: "angle (mrad)", digits: 1, colour: "robot", dash: DASH },
      ],
      150,
    );
    this.floor = make("div", {}, heading("Explored"), this.explored.box);
    this.words = heading("Map correction");
    const why = note("After a loop closure links and map disagree: correction spreads the error.");
    this.box = make(
      "div",
      {},
      note("The robot knows none of this."),
      this.switches.box,
      this.table.box,
      this.errors.box,
      this.floor,
      heading("Stored"),
      this.counts.box,
      this.words,
      why,
      this.residual.box,
    );
  }

  /** @param {{ residual: string | null }} data @param {import("./senses.js").Arrays} arrays */
  series({ residual }, arrays) {
    if (residual === null) return;
    say(this.words, `Map correction: a residual of ${residual}`);
    const of = (/** @type {string} */ name) => arrays[name].values;
    this.errors.show([of("time_s"), of("map_error_m"), of("odometry_error_m")]);
    const explored = of("explored_percent");
    this.floor.hidden = Number.isNaN(explored[explored.length - 1]); // a recording has no office
    this.explored.show([of("time_s"), explored]);
    this.counts.show([of("time_s"), of("views"), of("experiences")]);
    this.residual.show([of("time_s"), of("residual_mm"), of("residual_mrad")]);
  }

  /** Draws the plots anew after a change of theme. */
  recolour() {
    for (const plot of [this.errors, this.explored, this.counts, this.residual]) if (plot.plot) plot.build();
  }

  get parts() {
    return {
      switches: this.switches.show.bind(this.switches),
      /** @param {{ table: import("./parts.js").TableData }} data */
      numbers: ({ table }) => this.table.show(table),
      series: this.series.bind(this),
    };
  }
}

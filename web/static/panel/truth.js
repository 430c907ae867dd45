// Truth: how far map and odometry are from the robot's true place, and how far the map is from its own links.

import { make, say } from "../ui/elements.js";
import { heading, note, Table } from "./parts.js";
import { Plot } from "./plot.js";
import { SwitchList } from "./switch_list.js";

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
    this.words = heading("Map correction");
    const why = note("A closed loop makes links and map disagree; correction spreads the difference over the map.");
    this.box = make(
      "div",
      {},
      note("The robot knows none of this."),
      this.switches.box,
      this.table.box,
      this.errors.box,
      heading("What it has stored"),
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
    this.counts.show([of("time_s"), of("views"), of("experiences")]);
    this.residual.show([of("time_s"), of("residual_mm"), of("residual_mrad")]);
  }

  /** Draws the plots anew after a change of theme. */
  recolour() {
    for (const plot of [this.errors, this.counts, this.residual]) if (plot.plot) plot.build();
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

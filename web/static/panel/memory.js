// Memory: the layers over the plates, what has been stored, the goal, the snaps, and what the marks mean.

import { make } from "../ui/elements.js";
import { heading, SwitchList, Tables } from "./parts.js";

const MARKS = [
  ["numbered pill", "a packet and its share of all activity"],
  ["S, dashes, F", "the last snap: where the winning packet was (start) and where the views brought it (finish)"],
  ["ring on the floor", "the goal's cell; bright cells are near it in time (goal memory, needs a goal)"],
  ["arrow at the packet", "where the times to the goal fall fastest"],
  ["line", "the winner's way of the last two minutes"],
];

export class MemoryTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.switches = new SwitchList("Memory", ask);
    this.tables = new Tables();
    const marks = MARKS.flatMap(([mark, words]) => [
      make("dt", { textContent: mark }),
      make("dd", { textContent: words }),
    ]);
    const legend = make(
      "details",
      {},
      make("summary", { textContent: "Marks among the pose cells" }),
      make("dl", {}, ...marks),
    );
    this.box = make("div", {}, heading("On the plates"), this.switches.box, legend, this.tables.box);
  }

  get parts() {
    return {
      switches: this.switches.show.bind(this.switches),
      /** @param {{ tables: import("./parts.js").TableData[] }} data */
      memory: ({ tables }) => this.tables.show(tables),
    };
  }
}

// Two brains on the same senses: a menu of the second ones, such as one without one of our additions, and a strip on the stage that
// says in words and figures how the two differ.

import { fine } from "../ui/words.js";
import { ADDITIONS } from "../shared.js";
import { $, find, make, renew, say } from "../ui/elements.js";

const WHAT = { packet: "packet", view: "view", experience: "experience", link: "link" };

/** The columns of the table: its heads, and the cells of a brain. */
export const HEADS = ["experiences", "links", "relocalised", "map error", "off by"];

/** What the columns say that is not plain. @type {Record<string, string>} */
export const MEANS = {
  relocalised: "How often the winning packet snapped to another place.",
  "map error": "All of the way beside the true one, after alignment.",
  "off by":
    "How far the robot is from where it believes itself to be beside the active experience: nothing on new ground, however bent the map is.",
};

/** @param {BrainFields} brain */
export const cellsOf = ({ experiences, links, relocalisations, error_map_m, off_m }) => [
  String(experiences),
  String(links),
  String(relocalisations),
  metres(error_map_m),
  metres(off_m),
];

/** Since when they differ in something, and how. @param {DifferenceFields} difference */
export const sinceWhen = ({ kind, tick, time_s, words }) => ({
  button: `${WHAT[kind]} ${fine(time_s)}`,
  title: `Since tick ${tick}: ${words}. Show that moment.`,
});

/** A parameter's value in words. @param {Value} value */
const valueWords = (value) =>
  typeof value === "boolean"
    ? value
      ? "on"
      : "off"
    : typeof value === "number"
      ? String(+value.toPrecision(4))
      : value;

/** How many parameters make the difference, and the first of them. @param {ChangedField[]} changed */
export function changedWords(changed) {
  const rows = changed.map(({ name, first, second }) => `${name}: ${valueWords(first)} → ${valueWords(second)}`);
  const more = rows.length > SHOWN ? [`and ${rows.length - SHOWN} more`] : [];
  const button = changed.length === 1 ? "1 parameter" : `${changed.length} parameters`;
  return { button, title: [...rows.slice(0, SHOWN), ...more].join("\n") };
}
const SHOWN = 6;

/** @param {BesideFields} beside */
export const odometryWords = ({ error_odometry_m }) =>
  error_odometry_m === null ? "" : `Odometry alone: ${metres(error_odometry_m)}`;

/** @param {number | null} value */
const metres = (value) => (value === null ? "-" : `${value.toFixed(2)} m`);

/** Those that the first brain has, and those that it lacks. @param {AdditionsOff} off */
export function additionGroups({ beginning }) {
  const names = ADDITIONS.map(({ name }) => name);
  return [
    { label: "On: the second does without", names: names.filter((name) => !beginning.includes(name)) },
    { label: "Off: the second has it", names: names.filter((name) => beginning.includes(name)) },
  ].filter((group) => group.names.length);
}

/** What one is good for, and what the buttons say. now: empty where a running brain cannot change it. @param {string} name @param {AdditionsOff} off */
export function additionChoice(name, off) {
  const { adds, why, live } = ADDITIONS.find((addition) => addition.name === name) ?? ADDITIONS[0];
  const way = (/** @type {string[]} */ lacking) => (lacking.includes(name) ? "with" : "without");
  return {
    about: `${adds[0].toUpperCase()}${adds.slice(1)}: ${why}.`,
    anew: `Begin again ${way(off.beginning)} it`,
    now: live ? `From now on ${way(off.now)} it` : "",
  };
}

export class BesideStrip {
  /** @param {(wish: Command, done?: string) => Promise<boolean>} command */
  constructor(command) {
    this.command = command;
    this.drawn = "";
    this.additions = new AdditionChoice((pair, since) => this.begin(pair, since));
    $("beside-heads").append(
      ...HEADS.map((text) => make("th", { scope: "col", textContent: text, title: MEANS[text] ?? "" })),
    );
    $("beside-end").addEventListener("click", () => this.command({ type: "end_comparison" }));
  }

  /** @param {PairChoice} pair */
  choice({ name, title, about, since }) {
    const small = since === "beginning" ? [make("small", { textContent: about })] : [];
    const button = make("button", { type: "button" }, make("span", { textContent: title }), ...small);
    button.dataset.key = name;
    button.addEventListener("click", () => this.begin(name, since));
    return button;
  }

  /** @param {string} pair @param {"beginning" | "now"} since */
  begin(pair, since) {
    $("brains").open = false;
    this.command({ type: "compare_brains", pair, since }, "Two brains, the same senses. The first one drives.");
  }

  /**
   * @param {BesideFields | null} beside
   * @param {PairChoice[]} pairs what could be compared with the first brain
   * @param {AdditionsOff} off our additions that it lacks
   */
  show(beside, pairs, off) {
    this.additions.show(off);
    for (const [since, id] of /** @type {const} */ ([
      ["beginning", "brains-anew"],
      ["now", "brains-now"],
    ])) {
      const offered = pairs.filter((pair) => pair.since === since);
      renew($(id), offered, () => offered.map((pair) => this.choice(pair)));
    }
    $("beside").hidden = beside === null;
    document.body.dataset.beside = String(beside !== null);
    find(document, "button[data-view='all']").textContent = beside ? "Both" : "All";
    if (!beside) return;
    ["first", "second"].forEach((which, k) => {
      const brain = k === 0 ? beside.first : beside.second;
      const row = /** @type {HTMLTableRowElement} */ ($(k === 0 ? "beside-first" : "beside-second"));
      const cells = [brain.name, ...cellsOf(brain)];
      while (row.cells.length < cells.length) row.append(make("td", { className: which }));
      for (const [at, text] of cells.entries()) say(row.cells[at], text);
    });
    say($("beside-odometry"), odometryWords(beside));
    this.showDifferences(beside.differences);
    renew($("beside-values"), [beside.first.name, beside.second.name, beside.changed], () => this.values(beside));
  }

  /** Each parameter in which they differ, and its value in both. @param {BesideFields} beside */
  values({ first, second, changed }) {
    const summary = find($("beside-changed"), "summary");
    const { button, title } = changedWords(changed);
    [summary.textContent, /** @type {HTMLElement} */ (summary).title] = [button, title];
    const heads = find($("beside-changed"), "thead tr");
    const named = [first.name, second.name].map((text) => make("th", { scope: "col", textContent: text }));
    heads.replaceChildren(heads.children[0], ...named);
    return changed.map(({ name, ...values }) => {
      const cells = [values.first, values.second].map((value) => make("td", { textContent: valueWords(value) }));
      return make("tr", {}, make("th", { scope: "row", textContent: name }), ...cells);
    });
  }

  /** @param {DifferenceFields[]} differences */
  showDifferences(differences) {
    const drawn = JSON.stringify(differences);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    say($("beside-since"), differences.length ? "They differ since:" : "No difference yet.");
    $("beside-differences").replaceChildren(
      ...differences.map((difference) => {
        const { button, title } = sinceWhen(difference);
        const made = make("button", { type: "button", className: "tiny", textContent: button, title });
        made.setAttribute("aria-label", `${button}. ${title}`);
        const tick = Math.max(1, difference.tick); // at the end of tick 0 the second brain had not begun
        made.addEventListener("click", () => this.command({ type: "seek", tick }));
        return made;
      }),
    );
  }
}

/** One of our additions, chosen by name, with what it is good for. */
class AdditionChoice {
  /** @param {(name: string, since: "beginning" | "now") => void} begin */
  constructor(begin) {
    /** @type {AdditionsOff} */
    this.off = { beginning: [], now: [] };
    this.select = $("brains-addition");
    this.select.addEventListener("change", () => this.explain());
    $("brains-addition-anew").addEventListener("click", () => begin(this.select.value, "beginning"));
    $("brains-addition-now").addEventListener("click", () => begin(this.select.value, "now"));
  }

  /** @param {AdditionsOff} off */
  show(off) {
    this.off = off;
    const chosen = this.select.value;
    renew(this.select, off, () =>
      additionGroups(off).map(({ label, names }) =>
        make("optgroup", { label }, ...names.map((value) => make("option", { value, textContent: value }))),
      ),
    );
    if (chosen) this.select.value = chosen;
    this.explain();
  }

  explain() {
    const { about, anew, now } = additionChoice(this.select.value, this.off);
    say($("brains-about"), about);
    say($("brains-addition-anew"), anew);
    say($("brains-addition-now"), now);
    $("brains-addition-now").hidden = now === "";
  }
}

// When two branches parted, and both side by side on one clock: both maps, both packets, both errors, and where they differ first.

import { $, make, svg } from "../ui/elements.js";
import { fine } from "../ui/words.js";

const AROUND_M = 0.6;

/** Points turned by an angle, as the map lies on the stage. @param {number[][]} xy @param {number} turn_rad */
export function lying(xy, turn_rad) {
  const [cos, sin] = [Math.cos(turn_rad), Math.sin(turn_rad)];
  return xy.map(([x, y]) => [cos * x - sin * y, sin * x + cos * y]);
}

/** The viewBox in which all maps have room; y grows downwards there. @param {SideFields[]} sides */
export function frameOf(sides) {
  const all = sides.flatMap(({ xy, robot, turn_rad }) => lying([...xy, [robot.x, robot.y]], turn_rad));
  const [xs, ys] = [all.map(([x]) => x), all.map(([, y]) => -y)];
  const [left, top] = [Math.min(...xs) - AROUND_M, Math.min(...ys) - AROUND_M];
  return [left, top, Math.max(...xs) + AROUND_M - left, Math.max(...ys) + AROUND_M - top]
    .map((n) => n.toFixed(2))
    .join(" ");
}

/**
 * When two branches parted: the first time that they do not share.
 * @param {BranchFields[]} branches
 * @param {number} a
 * @param {number} b
 */
export function parted(branches, a, b) {
  const lines = [a, b].map((number) => lineOf(branches, number));
  let same = 0;
  while (lines[0][same] && lines[0][same] === lines[1][same]) same++;
  return Math.min(...lines.map((line) => line[same]?.from_s ?? Infinity));
}

/** A branch and its forebears, the first of them first. @param {BranchFields[]} branches @param {number} number */
function lineOf(branches, number) {
  /** @type {BranchFields[]} */
  const line = [];
  for (
    let at = branches.find((one) => one.number === number);
    at;
    at = branches.find((one) => one.number === at?.parent)
  )
    line.unshift(at);
  return line;
}

export class Comparison {
  /** @param {import("./timeline.js").Timeline} timeline @param {import("../net/connection.js").Connection} link */
  constructor(timeline, link) {
    this.timeline = timeline;
    this.link = link;
    this.drawn = "";
  }

  /** Begins or ends it. */
  toggle() {
    const { branch = 1, branches = [], sides = [] } = this.timeline.time ?? {};
    const other = branches.filter(({ number }) => number !== branch).at(-1);
    if (sides.length && !this.timeline.list.open) this.timeline.list.toggle();
    else if (sides.length) this.link.ask({ type: "compare_branch" });
    else if (other) this.with(other.number);
  }

  /** @param {number} number */
  async with(number) {
    const answer = await this.link.ask({ type: "compare_branch", number });
    if (answer.accepted && !this.timeline.list.open) this.timeline.list.toggle();
  }

  /** @param {TimeFields} time */
  show({ branch, branches, sides, differs }) {
    const drawn = JSON.stringify([branch, branches.length, sides, differs]);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    $("compare").hidden = sides.length === 0;
    if (!sides.length) return;
    const others = branches.filter(({ number }) => number !== branch);
    $("compare-with").replaceChildren(
      ...others.map(({ number }) => {
        const button = make("button", { type: "button", className: "tiny", textContent: String(number) });
        button.setAttribute("aria-label", `Compare with branch ${number}`);
        button.setAttribute("aria-pressed", String(number === sides[1].number));
        button.addEventListener("click", () => this.with(number));
        return button;
      }),
    );
    const frame = frameOf(sides);
    $("compare-sides").replaceChildren(...sides.map((side) => picture(side, frame)));
    $("compare-words").textContent = `${differs}.`;
  }
}

/** @param {SideFields} side @param {string} frame */
function picture(side, frame) {
  const { packet, robot, turn_rad } = side;
  const dots = lying(side.xy, turn_rad).map(([x, y]) => `M${x.toFixed(2)} ${(-y).toFixed(2)}h0`);
  const [[x, y]] = lying([[robot.x, robot.y]], turn_rad);
  const map = svg(
    "svg",
    { viewBox: frame, class: "side-map", role: "img", "aria-label": `The map of branch ${side.number}` },
    svg("path", { d: dots.join(""), class: "dots" }),
    svg("circle", { cx: x, cy: -y, r: 0.28, class: "robot" }),
  );
  const { map: error, odometry } = side.error_m;
  const errors = error === null || odometry === null ? [] : [error, odometry];
  const rows = [
    ...errors.map((value, k) => [k ? "of odometry" : "error of the map", `${value.toFixed(2)} m`]),
    ["experiences, links", `${side.experiences}, ${side.links}`],
    [
      "packet x′ y′ θ′",
      `${packet.x.toFixed(0)}, ${packet.y.toFixed(0)}, ${degrees(packet.heading_rad)}°: ${Math.round(100 * packet.mass)} %`,
    ],
  ].flatMap(([name, value]) => [make("dt", { textContent: name }), make("dd", { textContent: value })]);
  const title = make("p", {}, make("b", { textContent: `Branch ${side.number}` }), ` at ${fine(side.time_s)}`);
  return make("div", { className: "branch-side" }, title, map, make("dl", {}, ...rows));
}

/** @param {number} rad */
const degrees = (rad) => ((Math.round((180 * rad) / Math.PI) % 360) + 360) % 360;

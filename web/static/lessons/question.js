// The question: options to choose from, or a small plan to draw on, by a click or by arrow keys and Enter, with the votes of the
// class. The card and the page for votes have it.
// And the states of a lesson, with what card and page say in each.

import { clock, sentence } from "../ui/words.js";
import { make, say, svg } from "../ui/elements.js";

/** What stands over the lesson's title. @param {LessonView} lesson @param {LessonCard | null} card */
export function which(lesson, card) {
  const number = card && !card.own ? `Lesson ${card.number}` : "Lesson";
  return lesson.rounds > 1 ? `${number} · round ${lesson.round} of ${lesson.rounds}` : number;
}

/** Whether a round is over and another one follows: what is over has left marks. @param {LessonView} lesson */
const isBetween = ({ state, marks }) => state === "predict" && marks.length > 0;

/** Whether a prediction can still be made. @param {LessonView} lesson */
export const isOpen = (lesson) =>
  (lesson.state === "scene" || lesson.state === "predict") && lesson.round === 1 && !isBetween(lesson);

/** The words of the button that lets it happen; null: it cannot be pressed now. @param {LessonView} lesson */
export function showWords(lesson) {
  const { state, prediction, votes } = lesson;
  if (state !== "predict") return null;
  if (isBetween(lesson)) return "Show the next round";
  return prediction || voters(votes) ? "Let it happen" : "Just show me";
}

/** Whether it is left to play with before it came to its end. @param {LessonView} lesson */
export const isBroken = ({ state, outcome, doing }) => state === "sandbox" && !outcome && doing !== "";

/** Whether what to watch is told. @param {LessonView} lesson */
export const isWatched = (lesson) => lesson.state === "showing" || isBetween(lesson);

/** Which parts of the card are unfolded when a state begins: what the state is about. @param {LessonView} lesson */
export const unfolded = (lesson) => ({
  question: isOpen(lesson),
  outcome: lesson.state === "compared",
  sandbox: lesson.state === "sandbox",
});

/** Whether the plan is in sight: to draw on, and to compare. @param {LessonView} lesson */
export const isPlanShown = (lesson) => isOpen(lesson) || (lesson.draws !== null && lesson.state === "compared");

/** What is told before the question, and the question. @param {string} text */
export function inTwo(text) {
  const line = text.replace(/\s+/g, " ");
  const end = line.lastIndexOf(". ", Math.max(0, line.indexOf("?"))) + 1;
  return [line.slice(0, end), line.slice(end).trim()];
}

/** What is going on, or what is to be done. @param {LessonView} lesson */
export function doingWords(lesson) {
  const { state, doing, altered } = lesson;
  if (state === "scene") return "The scene is being set.";
  if (state === "showing" || isBroken(lesson) || isBetween(lesson)) return doing && sentence(doing);
  return altered && state !== "predict" ? "Changed by you." : "";
}

/** How many have voted. @param {LessonView["votes"]} votes */
const voters = ({ counts, points }) => counts.reduce((sum, count) => sum + count, 0) + points.length;

/** Each option's share of all votes, 0 without any. @param {number[]} counts */
export function shares(counts) {
  const all = counts.reduce((sum, count) => sum + count, 0);
  return counts.map((count) => (all ? count / all : 0));
}

/** What the class has predicted, in words; "" without votes. @param {LessonView} lesson */
export function classWords({ votes, outcome }) {
  const all = voters(votes);
  if (!all) return "";
  const have = `${all} ${all === 1 ? "vote" : "votes"}`;
  if (outcome?.choice === null || outcome?.choice === undefined) return have;
  return `${votes.counts[outcome.choice]} of ${all} predicted it`;
}

/**
 * Prediction and outcome beside one another.
 * @param {LessonView} lesson
 * @param {LessonText["predict"]} asked
 * @returns {{ tone: "right" | "wrong" | "none", head: string, said: string }}
 */
export function verdict({ prediction, outcome }, { options }) {
  if (!outcome || outcome.right === null || !prediction) return { tone: "none", head: "What happened", said: "" };
  const said =
    prediction.choice !== null
      ? options[prediction.choice]
      : outcome.distance_m === null
        ? "the point drawn"
        : `${outcome.distance_m.toFixed(1)} m from where it ended`;
  return outcome.right
    ? { tone: "right", head: "As predicted", said }
    : { tone: "wrong", head: "Not as predicted", said };
}

/**
 * The moments that are marked, one each, in their order: a moment is marked on both plates.
 * @param {LessonMark[]} marks
 * @param {(tick: number) => number} seconds
 */
export function moments(marks, seconds) {
  const seen = new Map(marks.map((mark) => [`${mark.tick} ${mark.words}`, mark]));
  return [...seen.values()]
    .sort((a, b) => a.tick - b.tick)
    .map(({ tick, words }) => ({ tick, words, at: clock(seconds(tick)) }));
}

/** The tab of the panel with this name in a lesson; null: it is none. @param {string} at @param {readonly string[]} tabs */
export const tabOf = (at, tabs) => tabs.find((tab) => tab.toLowerCase() === at) ?? null;

/** What the plate, the tab or the timeline is called. @param {string} at */
export const placeWords = (at) =>
  ({ office: "Office", pose: "Pose cells", map: "Map", timeline: "Timeline" })[at] ?? at[0].toUpperCase() + at.slice(1);

/** @param {LessonView | null} lesson @param {boolean} voted @param {LessonText["predict"]} asked */
export function voteWords(lesson, voted, { options }) {
  if (!lesson) return "Waiting for the question.";
  if (isOpen(lesson)) return voted ? "Your vote counts. You may still change it." : "What do you think will happen?";
  if (!lesson.outcome) return "It is being shown: look at the screen.";
  const { choice, words } = lesson.outcome;
  return choice === null || !options[choice] ? words : `It came true: ${options[choice]}. ${words}`;
}

/** A point turned about the origin, counter-clockwise. @param {Point} point @param {number} rad @returns {Point} */
export function turned([x, y], rad) {
  const [cos, sin] = [Math.cos(rad), Math.sin(rad)];
  return [x * cos - y * sin, x * sin + y * cos];
}

/**
 * Room around points, to be drawn with y upwards: the rectangle and the path of lines between them.
 * @param {[Point, Point][]} lines
 */
export function outline(lines) {
  const xs = lines.flatMap(([a, b]) => [a[0], b[0]]);
  const ys = lines.flatMap(([a, b]) => [a[1], b[1]]);
  const [left, right] = lines.length ? [Math.min(...xs), Math.max(...xs)] : [0, 1];
  const [bottom, top] = lines.length ? [Math.min(...ys), Math.max(...ys)] : [0, 1];
  const rim = 0.04 * Math.max(right - left, top - bottom, 1);
  const d = lines
    .map(([a, b]) => `M${a[0].toFixed(2)} ${a[1].toFixed(2)}L${b[0].toFixed(2)} ${b[1].toFixed(2)}`)
    .join("");
  return { left: left - rim, bottom: bottom - rim, width: right - left + 2 * rim, height: top - bottom + 2 * rim, d };
}

const STEP = 0.02; // of the plan's width, an arrow key
/** @type {Record<string, Point>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @typedef {{ name: string, at: Point, words: string, heading?: number }} Pin where something is; its name is its look */
/** @typedef {{ lines: [Point, Point][], dots: Point[], turn: number }} Drawing m, and the angle by which it is turned for the eye */

/** A small plan on which the class draws where it will end. */
class Plan {
  /** @param {(at: Point) => void} draw called with metres when somebody draws a point */
  constructor(draw) {
    this.draw = draw;
    this.open = false;
    this.frame = outline([]);
    this.turn = 0;
    /** @type {Point} */
    this.cross = [0, 0]; // where the arrow keys are, turned
    this.walls = svg("path", { class: "walls" });
    this.dots = svg("path", { class: "places" });
    this.pins = svg("g");
    this.upright = svg("g", {}, this.walls, this.dots, this.pins);
    this.box = svg("svg", { class: "lesson-plan", role: "application" }, this.upright);
    this.box.addEventListener("click", (event) => this.click(event));
    this.box.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {Drawing} drawing walls of the office, or links and places of the map */
  show({ lines, dots, turn }) {
    const at = (/** @type {Point} */ point) => turned(point, turn);
    const ends = [...lines, ...dots.map((dot) => /** @type {[Point, Point]} */ ([dot, dot]))];
    this.frame = outline(ends.map(([a, b]) => [at(a), at(b)]));
    this.turn = turn;
    const { left, bottom, width, height } = this.frame;
    this.cross = [left + width / 2, bottom + height / 2];
    this.box.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.upright.setAttribute(
      "transform",
      `translate(${-left} ${bottom + height}) scale(1 -1) rotate(${(turn * 180) / Math.PI})`,
    );
    this.walls.setAttribute("d", outline(lines).d);
    this.dots.setAttribute("d", outline(dots.map((dot) => [dot, dot])).d);
  }

  /** @param {boolean} open whether a point can be drawn @param {string} words @param {Pin[]} pins @param {Point[]} votes */
  mark(open, words, pins, votes) {
    this.open = open;
    this.box.setAttribute("aria-label", words);
    this.box.classList.toggle("open", open);
    if (open) this.box.setAttribute("tabindex", "0");
    else this.box.removeAttribute("tabindex");
    this.box.setAttribute("role", open ? "application" : "img");
    const r = Math.max(this.frame.width, this.frame.height) / 45;
    const dots = votes.map(([x, y]) => svg("circle", { cx: x, cy: y, r: r * 0.6, class: "vote" }));
    const marks = pins.flatMap(({ name, at: [x, y], words, heading }) => [
      ...(heading === undefined ? [] : [svg("path", { d: ahead([x, y], heading, r), class: name })]),
      svg("circle", { cx: x, cy: y, r, class: name }, svg("title", {}, words)),
    ]);
    const said = pins.find(({ name }) => name === "said");
    const was = pins.find(({ name }) => name === "was");
    const apart = said && was ? [svg("path", { d: `M${said.at}L${was.at}`, class: "apart" })] : [];
    const focused = document.activeElement === this.box && open;
    const cross = focused ? [this.crossed(r)] : [];
    this.pins.replaceChildren(...apart, ...dots, ...marks, ...cross);
  }

  /** @param {MouseEvent} event */
  click({ clientX, clientY }) {
    const to = this.open && this.upright.getScreenCTM()?.inverse();
    if (!to) return;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(to);
    this.cross = turned([x, y], this.turn);
    this.draw([x, y]);
  }

  /** The cross of the arrow keys, which stands upright however the plan is turned. @param {number} r */
  crossed(r) {
    const [x, y] = turned(this.cross, -this.turn);
    const d = `M${x - 2 * r} ${y}h${4 * r}M${x} ${y - 2 * r}v${4 * r}`;
    return svg("path", { d, class: "cross", transform: `rotate(${(-this.turn * 180) / Math.PI} ${x} ${y})` });
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = ARROWS[event.key];
    if (!this.open || (!step && event.key !== "Enter" && event.key !== " ")) return;
    event.preventDefault();
    if (!step) return this.draw(turned(this.cross, -this.turn));
    const { left, bottom, width, height } = this.frame;
    const [x, y] = this.cross;
    const by = STEP * Math.max(width, height);
    this.cross = [
      Math.min(left + width, Math.max(left, x + step[0] * by)),
      Math.min(bottom + height, Math.max(bottom, y + step[1] * by)),
    ];
    const old = this.pins.querySelector(".cross");
    const made = this.crossed(Math.max(width, height) / 45);
    old?.remove();
    this.pins.append(made);
  }
}

/** Where it looks. @param {Point} at @param {number} heading @param {number} r */
const ahead = ([x, y], heading, r) => `M${x} ${y}l${2.2 * r * Math.cos(heading)} ${2.2 * r * Math.sin(heading)}`;

/** The walls of the office, or links and places of the map as it is now. @param {"office" | "map"} plate @returns {Promise<Drawing>} */
async function drawingOf(plate) {
  if (plate === "office") {
    const { world } = await (await fetch("/api/world")).json();
    return { lines: world.walls.map((/** @type {Wall} */ wall) => [wall.from, wall.to]), dots: [], turn: 0 };
  }
  /** @type {{ map: { xy: Point[], links: [number, number][], turn_rad: number } }} */
  const { map } = await (await fetch("/api/state?map=1")).json();
  return { lines: map.links.map(([a, b]) => [map.xy[a], map.xy[b]]), dots: map.xy, turn: map.turn_rad };
}

/** @typedef {{ choice: number } | { x: number, y: number }} Said */

let count = 0; // of groups of radio buttons

export class Question {
  /** @param {LessonText["predict"]} asked @param {(said: Said) => void} predict @param {boolean} looks nobody answers here */
  constructor(asked, predict, looks = false) {
    this.asked = asked;
    this.looks = looks;
    this.votes = make("p", { className: "class-votes" });
    this.votes.setAttribute("role", "status");
    const group = `prediction-${++count}`;
    this.options = asked.options.map((words, choice) => {
      const input = make("input", { type: "radio", name: group });
      input.addEventListener("change", () => predict({ choice }));
      const bar = make("span", { className: "bar" });
      const votes = make("span", { className: "count" });
      const row = make("label", { className: "option" }, bar, input, make("span", { textContent: words }), votes);
      return { input, bar, votes, row };
    });
    this.plan = asked.draw ? new Plan(([x, y]) => predict({ x, y })) : null;
    const [setting, question] = inTwo(asked.question);
    const told = setting ? [make("span", { className: "setting", textContent: setting }), " "] : [];
    const legend = make("legend", {}, ...told, question);
    this.help = make("p", { className: "second", textContent: HELP });
    const rows = this.options.map(({ row }) => row);
    this.box = make("fieldset", { className: "question" }, legend, ...rows, ...(this.plan ? [] : [this.votes]));
    this.drawn = this.plan ? [make("div", { className: "drawn" }, this.help, this.plan.box, this.votes)] : []; // stays in sight longer
    this.compared = false; // whether the plan is that of the outcome
    this.ready = false; // whether it is that of the scene
    if (asked.plate === "office") this.redraw();
  }

  redraw() {
    if (!this.plan) return;
    drawingOf(this.asked.plate)
      .then((drawing) => this.plan?.show(drawing))
      .then(() => this.last && this.show(this.last, this.own, this.robot))
      .catch(() => say(this.help, "The plan could not be had."));
  }

  /** The map is drawn when the scene is set, and again when it is over, since it has moved meanwhile. @param {LessonView} lesson */
  follow({ state, outcome }) {
    if (this.asked.plate !== "map") return;
    const due = (!this.ready && state !== "scene") || (!this.compared && outcome !== null);
    this.ready = this.ready || state !== "scene";
    this.compared = outcome !== null;
    if (due) this.redraw();
  }

  /** @type {LessonView | null} */
  last = null;
  /** @type {LessonView["prediction"]} */
  own = null;

  /** @type {Pose | null} */
  robot = null;

  /** @param {LessonView} lesson @param {LessonView["prediction"]} own what was said here @param {Pose | null} robot where it is, or believes itself to be, on the plate */
  show(lesson, own, robot) {
    [this.last, this.own, this.robot] = [lesson, own, robot];
    const open = isOpen(lesson) && !this.looks;
    this.follow(lesson);
    this.showOptions(lesson, own, open);
    const shown = lesson.outcome !== null;
    this.help.hidden = !open && !shown;
    if (open || shown) say(this.help, shown ? LEGEND : HELP);
    say(this.votes, classWords(lesson));
    this.votes.hidden = !this.votes.textContent;
    this.plan?.mark(
      open,
      "Plan. Arrow keys move a cross, Enter draws there.",
      [...robotPin(robot), ...pinsOf(lesson, own)],
      lesson.votes.points,
    );
  }

  /** @param {LessonView} lesson @param {LessonView["prediction"]} own @param {boolean} open */
  showOptions(lesson, own, open) {
    const part = shares(lesson.votes.counts);
    for (const [k, { input, bar, votes, row }] of this.options.entries()) {
      input.disabled = !open;
      input.checked = own?.choice === k;
      bar.style.width = `${(100 * part[k]).toFixed(1)}%`;
      say(votes, lesson.votes.counts[k] ? String(lesson.votes.counts[k]) : "");
      row.dataset.look = lesson.outcome?.choice === k ? "true" : input.checked && lesson.outcome ? "false" : "";
    }
  }
}

const LEGEND = "Blue: predicted. Orange: where it ended. Ring: the robot.";
const HELP = "Click the plan, or use the arrow keys and Enter.";

/** Where it is now. @param {Pose | null} robot @returns {Pin[]} */
const robotPin = (robot) =>
  robot ? [{ name: "robot", at: [robot.x, robot.y], words: "the robot", heading: robot.heading_rad }] : [];

/** @param {LessonView} lesson @param {LessonView["prediction"]} own @returns {Pin[]} */
function pinsOf({ outcome }, own) {
  /** @type {Pin[]} */
  const pins = [];
  if (own && own.x !== null && own.y !== null) pins.push({ name: "said", at: [own.x, own.y], words: "the prediction" });
  if (outcome && outcome.x !== null && outcome.y !== null)
    pins.push({ name: "was", at: [outcome.x, outcome.y], words: "where it ended" });
  return pins;
}

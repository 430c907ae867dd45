// The question: options to choose from, or a plan to draw on, with the votes of the class. The card and the page for votes have it.

import { make, say } from "../ui/elements.js";
import { classWords, isOpen, shares } from "../model/lessons.js";
import { drawingOf, Plan } from "./plan.js";

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
    const legend = make("legend", { textContent: asked.question });
    this.help = make("p", { className: "second", textContent: HELP });
    const parts = this.plan ? [this.help, this.plan.box] : this.options.map(({ row }) => row);
    this.box = make("fieldset", { className: "question" }, legend, ...parts, this.votes);
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
const HELP = "Click the plan, or move the cross with the arrow keys and press Enter.";

/** Where it is now. @param {Pose | null} robot @returns {import("./plan.js").Pin[]} */
const robotPin = (robot) =>
  robot ? [{ name: "robot", at: [robot.x, robot.y], words: "the robot", heading: robot.heading_rad }] : [];

/** @param {LessonView} lesson @param {LessonView["prediction"]} own @returns {import("./plan.js").Pin[]} */
function pinsOf({ outcome }, own) {
  /** @type {import("./plan.js").Pin[]} */
  const pins = [];
  if (own && own.x !== null && own.y !== null) pins.push({ name: "said", at: [own.x, own.y], words: "the prediction" });
  if (outcome && outcome.x !== null && outcome.y !== null)
    pins.push({ name: "was", at: [outcome.x, outcome.y], words: "where it ended" });
  return pins;
}

// The words, groups and states of lessons. No DOM.

import { clock, sentence } from "../ui/words.js";

/** Each begins with the lesson named here; those behind it belong to it, too. */
const GROUPS = new Map([
  ["packet", "The packet: path integration"],
  ["loop", "The map: loops, snaps, places"],
  ["kidnapped", "Lost and found"],
  ["goal", "Going somewhere"],
  ["small", "Limits, and what we added"],
]);

/**
 * Lessons in their order, by chapter. Those of the user's own come last.
 * @param {LessonCard[]} cards
 */
export function chapters(cards) {
  /** @type {{ title: string, cards: LessonCard[] }[]} */
  const all = [];
  for (const card of cards.filter(({ own }) => !own)) {
    const title = GROUPS.get(card.name);
    if (title || !all.length) all.push({ title: title ?? "Lessons", cards: [] });
    all[all.length - 1].cards.push(card);
  }
  const own = cards.filter((card) => card.own);
  return own.length ? [...all, { title: "Your own", cards: own }] : all;
}

/** The lesson after this one, in their order; null after the last. @param {LessonCard[]} cards @param {string} name */
export function nextAfter(cards, name) {
  const good = cards.filter(({ wrong }) => wrong === null);
  const at = good.findIndex((card) => card.name === name);
  return at < 0 ? null : (good[at + 1] ?? null);
}

/** @param {LessonCard} card */
export function cardFacts({ paper, minutes, rounds }) {
  const long = minutes < 1.5 ? `${Math.max(5, 5 * Math.round(minutes * 12))} s` : `${Math.round(minutes)} min`;
  return `${paper} · ${long}${rounds > 1 ? ` · ${rounds} rounds` : ""}`;
}

/** What stands over the lesson's title. @param {LessonView} lesson @param {LessonCard | null} card */
export function which(lesson, card) {
  const number = card && !card.own ? `Lesson ${card.number} · ${card.paper}` : (card?.paper ?? "Lesson");
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

/** Whether what to watch is told: while it happens, and afterwards if Inspect tells why. @param {LessonView} lesson @param {LessonText} text */
export const isWatched = (lesson, { explains }) =>
  lesson.state === "showing" || isBetween(lesson) || (lesson.state === "compared" && explains);

/** What is going on, or what is to be done. @param {LessonView} lesson */
export function doingWords(lesson) {
  const { state, doing, altered, prediction } = lesson;
  if (isBroken(lesson)) return `${sentence(doing)} "Once more" begins it again.`;
  if (state === "scene") return "The scene is being set.";
  if (state === "showing") return doing && sentence(doing);
  if (state !== "predict") return altered ? "You have changed something: this is yours now." : "";
  return isBetween(lesson) ? doing && sentence(doing) : prediction ? "" : "First say what you think will happen.";
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
  return `${votes.counts[outcome.choice]} of ${have} were for it`;
}

/**
 * Prediction and outcome beside one another.
 * @param {LessonView} lesson
 * @param {LessonText["predict"]} asked
 * @returns {{ tone: "right" | "wrong" | "none", head: string, said: string, was: string }}
 */
export function verdict({ prediction, outcome }, { options }) {
  const choice = outcome?.choice ?? null;
  const was = choice === null ? "" : options[choice];
  if (!outcome || outcome.right === null || !prediction) return { tone: "none", head: "What happened", said: "", was };
  const said =
    prediction.choice !== null
      ? options[prediction.choice]
      : outcome.distance_m === null
        ? "the point drawn"
        : `${outcome.distance_m.toFixed(1)} m from where it ended`;
  return outcome.right
    ? { tone: "right", head: "As predicted", said, was: "" }
    : { tone: "wrong", head: "Not as predicted", said, was };
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

/** The name of a lesson in an address, `#lesson=NAME`; null without one. @param {string} hash */
export const linked = (hash) => /^#lesson=([a-z0-9-]{1,40})$/.exec(hash)?.[1] ?? null;

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

// The states of a lesson, and what the card and the page for votes say in each.

import { clock, sentence } from "../ui/words.js";

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

/** @param {LessonView | null} lesson @param {boolean} voted @param {LessonText["predict"]} asked */
export function voteWords(lesson, voted, { options }) {
  if (!lesson) return "Waiting for the question.";
  if (isOpen(lesson)) return voted ? "Your vote counts. You may still change it." : "What do you think will happen?";
  if (!lesson.outcome) return "It is being shown: look at the screen.";
  const { choice, words } = lesson.outcome;
  return choice === null || !options[choice] ? words : `It came true: ${options[choice]}. ${words}`;
}

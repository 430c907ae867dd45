// What the page for votes says. No DOM.

import { isOpen } from "./lessons.js";

/** @param {LessonView | null} lesson @param {boolean} voted @param {LessonText["predict"]} asked */
export function voteWords(lesson, voted, { options }) {
  if (!lesson) return "Waiting for the question.";
  if (isOpen(lesson)) return voted ? "Your vote counts. You may still change it." : "What do you think will happen?";
  if (!lesson.outcome) return "It is being shown: look at the screen.";
  const { choice, words } = lesson.outcome;
  return choice === null || !options[choice] ? words : `It came true: ${options[choice]}. ${words}`;
}

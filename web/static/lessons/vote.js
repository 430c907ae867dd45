// The question alone, for a class: each browser has one vote, which can be changed until it is shown. It asks once a second, so
// that many phones cost little.

import { voteWords, Question } from "./question.js";
import { reasons } from "../net/post.js";
import { keep, kept, say } from "../ui/elements.js";

/** @typedef {import("./question.js").Said} Said */

const EVERY_MS = 1000;
const me = voter();
/** @param {keyof VoteIds} id */
const $ = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @type {LessonText | null} */
let text = null;
/** @type {Question | null} */
let question = null;
/** @type {LessonView | null} */
let lesson = null;
/** @type {LessonView["prediction"]} */
let own = null;
/** @type {Pose | null} */
let robot = null;
let wrong = "";
let begun = ""; // which lesson is asked about: the name, and the run of it

document.documentElement.dataset.theme = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
look();

async function look() {
  try {
    const answer = await fetch("/api/state");
    if (answer.ok) await take(await answer.json());
  } catch {
    wrong = "The connection is lost. Trying again.";
  }
  draw();
  setTimeout(look, EVERY_MS);
}

/** @param {State} state */
async function take({ lesson: now, robot: at, estimate }) {
  robot = now?.draws === "map" ? estimate : at;
  wrong = "";
  const again = lesson?.outcome && !now?.outcome; // the same lesson, once more
  lesson = now;
  if (now && (now.name !== begun || again)) await begin(now.name);
}

/** @param {string} name */
async function begin(name) {
  const answer = await fetch(`/api/lessons/${name}`);
  if (!answer.ok) return;
  const loaded = /** @type {LessonText} */ (await answer.json());
  [text, own, begun] = [loaded, null, name];
  question = new Question(loaded.predict, vote);
  $("vote-question").replaceChildren(question.box, ...question.drawn);
}

/** @param {Said} said */
async function vote(said) {
  if (!text) return;
  own = { choice: null, x: null, y: null, ...said };
  draw();
  const body = JSON.stringify({ lesson: text.card.name, voter: me, ...said });
  try {
    const answer = await fetch("/api/vote", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body,
    });
    if (answer.ok) return;
    own = null;
    wrong = reasons(await answer.json());
  } catch {
    own = null;
    wrong = "The connection is lost; your vote has not arrived.";
  }
  draw();
}

function draw() {
  const there = lesson !== null && text !== null && lesson.name === begun;
  $("vote-question").hidden = !there;
  say($("vote-title"), there && text ? text.card.title : "RatSLAM");
  if (there && lesson) question?.show(lesson, own, robot);
  say(
    $("vote-said"),
    wrong ||
      voteWords(
        there ? lesson : null,
        own !== null,
        text?.predict ?? { question: "", options: [], draw: null, plate: "office" },
      ),
  );
}

/** A text that is this browser's own. Each voter counts once. */
function voter() {
  const name = [...crypto.getRandomValues(new Uint8Array(12))].map((byte) => byte.toString(16)).join("-");
  const own = kept("voter") ?? name;
  keep("voter", own);
  return own;
}

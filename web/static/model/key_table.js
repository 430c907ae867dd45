// Every key of the page, once: the page acts by this table, and the help is written from it. No DOM.

/**
 * `keys`: as the browser calls them, lower case. `act`: what they do; main.js has a function for each. `words`: for people.
 * @typedef {{ keys: readonly string[], act: string, words: string }} Row
 * @typedef {{ title: string, rows: readonly Row[] }} Group
 */

export const GROUPS = /** @type {const} */ ([
  {
    title: "Robot",
    rows: [
      { keys: ["e"], act: "explore", words: "explore by itself" },
      { keys: ["k"], act: "kidnap", words: "kidnap: somewhere else, untold" },
      { keys: ["/"], act: "places", words: "choose a place to go to from a list" },
      { keys: ["x"], act: "cancel", words: "cancel the goal" },
    ],
  },
  {
    title: "Time",
    rows: [
      { keys: [" "], act: "play", words: "play or pause" },
      { keys: ["."], act: "tick", words: "one tick" },
      { keys: [","], act: "stage", words: "one stage of a tick" },
      { keys: ["b"], act: "tickBack", words: "a tick back" },
      { keys: ["j"], act: "secondBack", words: "a second back" },
      { keys: ["l"], act: "secondOn", words: "a second on" },
      { keys: ["["], act: "eventBack", words: "event before" },
      { keys: ["]"], act: "eventOn", words: "next event" },
      { keys: ["n"], act: "now", words: "back to now" },
      { keys: ["v"], act: "events", words: "all events" },
      { keys: ["m"], act: "bookmark", words: "bookmark this moment" },
      { keys: ["h"], act: "goOn", words: "go on from the moment shown" },
    ],
  },
  {
    title: "Looking",
    rows: [
      { keys: ["1"], act: "view1", words: "all plates" },
      { keys: ["2"], act: "view2", words: "office" },
      { keys: ["3"], act: "view3", words: "pose cells" },
      { keys: ["4"], act: "view4", words: "map" },
      { keys: ["f"], act: "follow", words: "the camera follows the robot" },
      { keys: ["i"], act: "vision", words: "vision off, or on again" },
      { keys: ["r"], act: "replay", words: "the last loop closure again" },
      { keys: ["p"], act: "panel", words: "show or hide the panel" },
      { keys: ["t"], act: "theme", words: "light or dark" },
    ],
  },
  {
    title: "Presenter",
    rows: [
      { keys: ["z"], act: "present", words: "present, or end it" },
      { keys: ["PageDown"], act: "next", words: "next" },
      { keys: ["PageUp"], act: "back", words: "back" },
      { keys: ["q"], act: "spotlight", words: "spotlight" },
    ],
  },
  {
    title: "Page",
    rows: [
      { keys: ["c"], act: "lessons", words: "lessons" },
      { keys: ["g"], act: "gallery", words: "experiments" },
      { keys: ["o"], act: "edit", words: "edit the office" },
      { keys: ["?"], act: "help", words: "this help" },
      { keys: ["Escape"], act: "escape", words: "close what is open" },
    ],
  },
]);

/** @typedef {(typeof GROUPS)[number]["rows"][number]["act"]} Act */

const BY_KEY = new Map(
  GROUPS.flatMap(({ rows }) => rows.flatMap(({ keys, act }) => keys.map((key) => /** @type {const} */ ([key, act])))),
);

/** What a key does; undefined: nothing. @param {string} key @returns {Act | undefined} */
export const actOf = (key) => BY_KEY.get(/** @type {any} */ (key));

/** A key as it is written on keyboards. @param {string} key */
export const written = (key) => ({ " ": "space", Escape: "esc", PageDown: "page down", PageUp: "page up" })[key] ?? key;

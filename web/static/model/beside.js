// Two brains in words and figures. No DOM.

import { fine } from "./timeline.js";

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
export const valueWords = (value) =>
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

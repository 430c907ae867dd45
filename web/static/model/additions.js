// Our additions as choices for a second brain, in words. No DOM.

import { ADDITIONS } from "../shared.js";

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

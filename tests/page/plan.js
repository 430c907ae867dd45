// What a person does in the world editor: opens it, clicks and drags on its plan.

import { told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** @returns {Promise<any>} */
export const world = async () => (await told("world")).world;

/** @param {string} what @param {(world: any) => unknown} fits */
export const worldIs = (what, fits) => until(what, async () => fits(await world()));

/** @param {number} count */
export const wallsAre = (count) => worldIs(`${count} walls`, (now) => now.walls.length === count);

/** @param {Page} page */
export async function edit(page) {
  await page.click("#edit");
  await until("the plan is drawn", () => page.find("#plan .outer") && page.find("#plan .body"));
  await page.fill("#grid", "0.25"); // this DOM begins with the first option, whichever is marked as selected
}

/** @param {Page} page @param {string} words */
export const says = (page, words) => page.says("#plan-status", words);

/** Where a point of the office (10 x 8 m) is on the plan, by its drawn outline. @param {Page} page @param {number} x @param {number} y @returns {[number, number]} */
function at(page, x, y) {
  const numbers = page
    .find("#plan .outer")
    .getAttribute("d")
    .match(/[\d.]+/g)
    .map(Number);
  const [across, down] = [0, 1].map((k) =>
    numbers.filter((/** @type {number} */ _, /** @type {number} */ n) => n % 2 === k),
  );
  const [left, right, top, bottom] = [Math.min(...across), Math.max(...across), Math.min(...down), Math.max(...down)];
  return [left + ((right - left) * x) / 10, bottom - ((bottom - top) * y) / 8];
}

/** @param {Page} page @param {...[number, number]} points */
export function click(page, ...points) {
  for (const point of points) page.drag("#plan", [at(page, ...point)]);
}

/** @param {Page} page @param {[number, number]} start @param {[number, number]} end */
export function drag(page, start, end) {
  const [from, to] = [at(page, ...start), at(page, ...end)];
  page.drag("#plan", [from, [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2], to]);
}

// What a person does in the world editor: opens it, clicks and drags on its plan.

import { path } from "../unit/static/made.js";
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

/** Where points of the office (10 x 8 m) are on the plan, by its drawn outline. @param {Page} page @param {string} points as in an SVG: "1 2, 3 2" */
function on(page, points) {
  const [xs, ys] = [/** @type {number[]} */ ([]), /** @type {number[]} */ ([])];
  for (const [k, number] of page
    .find("#plan .outer")
    .getAttribute("d")
    .match(/[\d.]+/g)
    .entries())
    (k % 2 ? ys : xs).push(Number(number));
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  return path(points).map(
    ([x, y]) => /** @type {Point} */ ([left + ((right - left) * x) / 10, bottom - ((bottom - top) * y) / 8]),
  );
}

/** @param {Page} page @param {string} points */
export function click(page, points) {
  for (const point of on(page, points)) page.drag("#plan", [point]);
}

/** @param {Page} page @param {string} ends */
export function drag(page, ends) {
  const [from, to] = on(page, ends);
  page.drag("#plan", [from, [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2], to]);
}

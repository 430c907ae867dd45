// The plan of an experiment's world: stands for its figure until there is one.

import { svg } from "../ui/elements.js";

/** @param {PlanDrawing} plan */
export function planOf({ width, depth, left, bottom, walls, way, places }) {
  const dots = places.map(([x, y]) => svg("circle", { cx: x, cy: y, r: Math.max(width, depth) / 45, class: "goal" }));
  const upright = svg(
    "g",
    { transform: `translate(${-left} ${bottom + depth}) scale(1 -1)` },
    svg("path", { d: walls, class: "walls" }),
    svg("path", { d: way, class: "way" }),
    ...dots,
  );
  return svg("svg", { viewBox: `0 0 ${width} ${depth}`, class: "plan", "aria-hidden": "true" }, upright);
}

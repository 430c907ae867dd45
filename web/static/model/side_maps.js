// Maps of two branches, drawn in one frame. No DOM.

const AROUND_M = 0.6;

/** Points turned by an angle, as the map lies on the stage. @param {number[][]} xy @param {number} turn_rad */
export function lying(xy, turn_rad) {
  const [cos, sin] = [Math.cos(turn_rad), Math.sin(turn_rad)];
  return xy.map(([x, y]) => [cos * x - sin * y, sin * x + cos * y]);
}

/** The viewBox in which all maps have room; y grows downwards there. @param {SideFields[]} sides */
export function frameOf(sides) {
  const all = sides.flatMap(({ xy, robot, turn_rad }) => lying([...xy, [robot.x, robot.y]], turn_rad));
  const [xs, ys] = [all.map(([x]) => x), all.map(([, y]) => -y)];
  const [left, top] = [Math.min(...xs) - AROUND_M, Math.min(...ys) - AROUND_M];
  return [left, top, Math.max(...xs) + AROUND_M - left, Math.max(...ys) + AROUND_M - top]
    .map((n) => n.toFixed(2))
    .join(" ");
}

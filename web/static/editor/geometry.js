// Points and lines of the office, metres.

const ROUND = 1000; // to the millimetre

/** @param {number} value @param {number} [per] */
export const round = (value, per = ROUND) => Math.round(value * per) / per;

/** @param {number} x @param {number} y @returns {Point} */
export const point = (x, y) => [x, y];

/** A point rounded to the millimetre. @param {number} x @param {number} y @returns {Point} */
export const at = (x, y) => [round(x), round(y)];

/** @param {Point} p @param {Point} d */
export const plus = ([x, y], [dx, dy]) => at(x + dx, y + dy);

/** @param {Point} a @param {Point} b */
export const away = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** @param {Point} p @param {number} degrees @returns {Point} */
export const turned = ([x, y], degrees) => {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return [x * c - y * s, x * s + y * c];
};

/** The direction from one point to another, to a tenth of a degree. @param {Point} from @param {Point} to */
export const degrees = (from, to) => round((Math.atan2(to[1] - from[1], to[0] - from[0]) * 180) / Math.PI, 10);

/** How far a point is from the nearest of a segment. @param {Point} p @param {Point} a @param {Point} b */
export function toSegment(p, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const u = Math.max(0, Math.min(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
  return away(p, [a[0] + u * dx, a[1] + u * dy]);
}

/** How far a point is from the nearest of an open path. @param {Point} p @param {Point[]} path */
export const toPath = (p, path) =>
  path.length === 1 ? away(p, path[0]) : Math.min(...path.slice(1).map((b, k) => toSegment(p, path[k], b)));

/** How far a point is from an area: 0 inside. @param {Point} p @param {Point[]} ring */
export const toArea = (p, ring) => (within(p, ring) ? 0 : toPath(p, [...ring, ring[0]]));

/** Whether a ray from the point crosses the ring an odd number of times. @param {Point} p @param {Point[]} ring */
export function within(p, ring) {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [[x, y], [u, v]] = [ring[i], ring[j]];
    if (y > p[1] !== v > p[1] && p[0] < ((u - x) * (p[1] - y)) / (v - y) + x) inside = !inside;
  }
  return inside;
}

/** @param {Wall} wall */
export const length = (wall) => away(wall.from, wall.to);

/** Where the leaf of a door ends; opening: 0 shut, 1 open. @param {Door} door @param {number} [opening] */
export const tip = (door, opening = 0) => {
  if (door.slides) return plus(hinge(door, opening), turned([door.width, 0], door.angle_deg));
  return plus(door.hinge, turned([door.width, 0], door.angle_deg + opening * (door.swing_deg ?? 90)));
};

/** Where the leaf of a door begins. @param {Door} door @param {number} [opening] */
export const hinge = (door, opening = 0) =>
  door.slides ? plus(door.hinge, turned([-door.width * opening, 0], door.angle_deg)) : door.hinge;

/** @param {Pick<BoxItem, "x" | "y" | "width" | "depth" | "angle_deg">} box */
export const corners = (box) => {
  const [a, b] = [box.width / 2, box.depth / 2];
  /** @type {Point[]} */
  const straight = [
    [-a, -b],
    [a, -b],
    [a, b],
    [-a, b],
  ];
  return straight.map((corner) => plus([box.x, box.y], turned(corner, box.angle_deg ?? 0)));
};

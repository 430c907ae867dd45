// Pictures made of numbers, as RGBA pixels for a canvas. No DOM: colours are triples of bytes.

/**
 * @typedef {[number, number, number]} Rgb
 * @typedef {{ width: number, height: number, rgba: Uint8ClampedArray<ArrayBuffer> }} Pixels
 */

export const STRIP = { rows: 6, columns: 34, square: 6 }; // squares of the local view cells, and pixels of one

/** @param {string} colour "#rgb" or "#rrggbb" @returns {Rgb} */
export function rgb(colour) {
  const digits = colour.trim().slice(1);
  const pairs = digits.length === 3 ? [...digits].map((digit) => digit + digit) : (digits.match(/../g) ?? []);
  const [red = 0, green = 0, blue = 0] = pairs.map((pair) => Number.parseInt(pair, 16));
  return [red, green, blue];
}

/** `share` of the way from one colour to another. @param {Rgb} from @param {Rgb} to @param {number} share @returns {Rgb} */
export function mix(from, to, share) {
  const [red, green, blue] = from.map((value, k) => value + (to[k] - value) * share);
  return [red, green, blue];
}

/**
 * A picture of grey levels (height, width) or colours (height, width, 3), as they are.
 * @param {ArrayLike<number>} values
 * @param {number[]} shape
 * @returns {Pixels}
 */
export function picture(values, [height, width, channels = 1]) {
  const rgba = new Uint8ClampedArray(4 * width * height);
  for (let k = 0; k < width * height; k++) {
    for (let c = 0; c < 3; c++) rgba[4 * k + c] = values[channels * k + (channels === 3 ? c : 0)];
    rgba[4 * k + 3] = 255;
  }
  return { width, height, rgba };
}

/** How many views one square of the strip stands for. @param {number} views */
export const viewsASquare = (views) => Math.max(1, Math.ceil(views / (STRIP.rows * STRIP.columns)));

/**
 * A square for each view (or for several neighbours), lit while active and fading for a while after.
 * @param {{ views: number, active: number, recent: number[] }} cells `recent`: oldest first
 * @param {{ quiet: Rgb, lit: Rgb, active: Rgb, ground: Rgb }} colours
 * @returns {Pixels}
 */
export function viewStrip({ views, active, recent }, colours) {
  const { rows, columns, square } = STRIP;
  const [width, height, each] = [columns * square, rows * square, viewsASquare(views)];
  const rgba = new Uint8ClampedArray(4 * width * height);
  /** @param {number} number @param {Rgb} colour @param {number} opacity */
  const fill = (number, [red, green, blue], opacity) => {
    const [left, top] = [(number % columns) * square, Math.floor(number / columns) * square];
    for (let y = top; y < top + square - 1; y++)
      for (let x = left; x < left + square - 1; x++) rgba.set([red, green, blue, opacity], 4 * (y * width + x));
  };
  const last = rows * columns - 1;
  for (let k = 0; k <= last; k++) fill(k, colours.quiet, k < Math.ceil(views / each) ? 60 : 18);
  const faint = mix(colours.ground, colours.quiet, 0.3);
  recent.forEach((view, k) => {
    fill(Math.min(Math.floor(view / each), last), mix(faint, colours.lit, (k + 1) / (recent.length + 1)), 255);
  });
  if (active >= 0) fill(Math.min(Math.floor(active / each), last), colours.active, 255);
  return { width, height, rgba };
}

/**
 * Pose cells from above, the front row at the bottom: each column of cells in the colours of its packets.
 * @param {[number, number]} size rows (y′) and columns (x′)
 * @param {ArrayLike<number>} places y′ n_x + x′ of each entry
 * @param {ArrayLike<number>} packets the rank of its packet
 * @param {ArrayLike<number>} strength its activity, in any unit
 * @param {Rgb[]} colours of the packets by rank; higher ranks have the last one
 * @param {Rgb} ground where nothing is active
 * @returns {Pixels}
 */
export function fromAbove([height, width], places, packets, strength, colours, ground) {
  const sums = new Float64Array(4 * width * height); // red, green and blue weighted with the activity, then the sum of the activity
  for (let k = 0; k < places.length; k++) {
    const colour = colours[Math.min(packets[k], colours.length - 1)];
    for (let c = 0; c < 3; c++) sums[4 * places[k] + c] += colour[c] * strength[k];
    sums[4 * places[k] + 3] += strength[k];
  }
  let most = 1e-12;
  for (let k = 3; k < sums.length; k += 4) most = Math.max(most, sums[k]);
  const rgba = new Uint8ClampedArray(4 * width * height);
  for (let k = 0; k < width * height; k++) {
    const weight = sums[4 * k + 3];
    const at = 4 * ((height - 1 - Math.floor(k / width)) * width + (k % width));
    for (let c = 0; c < 3; c++) rgba[at + c] = weight > 0 ? sums[4 * k + c] / weight : ground[c];
    rgba[at + 3] = 28 + Math.sqrt(weight / most) * (255 - 28);
  }
  return { width, height, rgba };
}

/**
 * Bars on a common floor, as the path of an SVG of `values.length` by 100. The tallest reaches the top.
 * @param {ArrayLike<number>} values
 */
export function bars(values) {
  const tallest = Math.max(1e-9, ...Array.from(values));
  let path = "";
  for (let k = 0; k < values.length; k++) {
    const height = (100 * values[k]) / tallest;
    if (height > 0.5) path += `M${(k + 0.08).toFixed(2)} 100V${(100 - height).toFixed(1)}h.84V100z`;
  }
  return path;
}

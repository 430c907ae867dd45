// Sentences made of what the server says, of counts and of times, and the times that are written below a timeline.

/** The text with a full stop. @param {string} text */
export const ended = (text) => text + (/[.!?]$/.test(text) ? "" : ".");

/** The text with a capital letter and a full stop. For a text that begins with a file's name, use `ended`. @param {string} text */
export const sentence = (text) => text[0].toUpperCase() + ended(text.slice(1));

/** The refusal of an edit without the numbers that things have in the world's file. @param {string} reason */
export const plainly = (reason) =>
  reason.replace(/^steps\[\d+\]: /, "").replace(/^\w+\[\d+\] \((.+?)\)(?= would cover)/, "the $1");

/** @param {number} count */
export const experiences = (count) => `${count.toLocaleString("en")} ${count === 1 ? "experience" : "experiences"}`;

/** @param {number} bytes */
export const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

/** The first of my-world, my-world-2, ... that no world has. @param {WorldTitles} taken */
export function freeName({ yours, ours }) {
  let k = 1;
  const name = () => (k > 1 ? `my-world-${k}` : "my-world");
  while (name() in yours || name() in ours) k += 1;
  return name();
}

/** The words that offer a kept brain. @param {KeptOffer} kept @param {number} now_s since 1970 */
export function keptWords(kept, now_s) {
  const LONG_AGO_S = 12 * 3600;
  /** @type {Intl.DateTimeFormatOptions} */
  const day = now_s - kept.kept_at < LONG_AGO_S ? {} : { day: "numeric", month: "short", year: "numeric" };
  const when = new Date(kept.kept_at * 1000).toLocaleString("en-GB", { ...day, hour: "2-digit", minute: "2-digit" });
  return `${kept.title}, ${Math.round(kept.time_s / 60)} simulated minutes, ${experiences(kept.experiences)}, kept ${when}`;
}

const STEPS_S = [10, 30, 60, 120, 180, 300, 600, 900, 1800, 3600, 7200, 14400];
const PER_TICK_PX = 110;

/** 1:30, 1:02:30. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** The times written below the part of a timeline from `from` to `to` that is `width` pixels wide. @param {number} from @param {number} to @param {number} width */
export function tickTimesIn(from, to, width) {
  if (from <= 0) return tickTimes(to, width);
  const most = Math.max(3, Math.floor(width / PER_TICK_PX));
  const step = [1, 2, 5, ...STEPS_S].find((value) => (to - from) / value <= most) ?? tickTimes(to - from, width)[1];
  const times = [];
  for (let time = Math.ceil(from / step) * step; time <= to; time += step) times.push(time);
  return times;
}

/** The times written below a timeline of `end` seconds that is `width` pixels wide. @param {number} end @param {number} width */
export function tickTimes(end, width) {
  const most = Math.max(3, Math.floor(width / PER_TICK_PX));
  const step = STEPS_S.find((value) => end / value <= most) ?? Math.ceil(end / most / 3600) * 3600;
  const times = [];
  for (let time = 0; time <= end - step * 0.2; time += step) times.push(time);
  return times;
}

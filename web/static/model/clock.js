// Times for people, and which of them are written below the timeline. No DOM.

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

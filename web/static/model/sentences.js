// Sentences made of what the server says and of counts. No DOM.

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

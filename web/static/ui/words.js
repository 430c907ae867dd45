// Sentences made of what the server says, sizes and times in words.

/** The text with a full stop. @param {string} text */
export const ended = (text) => text + (/[.!?]$/.test(text) ? "" : ".");

/** The text with a capital letter and a full stop. For a text that begins with a file's name, use `ended`. @param {string} text */
export const sentence = (text) => text[0].toUpperCase() + ended(text.slice(1));

/** @param {number} bytes */
export const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

/** 1:30, 1:02:30. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** A time for people, to the tenth. @param {number} seconds */
export const fine = (seconds) => `${clock(seconds)}.${Math.floor(seconds * 10 + 1e-6) % 10}`;

// What the page says: sentences made of what the server says, sizes and times in words, and toasts, which are short sentences in the
// line beneath the stage: what was done, what was refused, what people should know. Text only, never HTML.

import { $, icon } from "./elements.js";

/** The text with a full stop. @param {string} text */
export const ended = (text) => text + (/[.!?]$/.test(text) ? "" : ".");

/** The text with a capital letter and a full stop. For a text that begins with a file's name, use `ended`. @param {string} text */
export const sentence = (text) => text[0].toUpperCase() + ended(text.slice(1));

/** @param {number} bytes */
export const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

const PAPERS = /** @type {Record<string, string>} */ ({
  A: "ACRA 2004",
  B: "ACRA 2005",
  C: "IROS 2005",
  D: "ACRA 2006",
});

/** A source with its papers' names: "A 6.2, B 5" is "ACRA 2004 6.2, ACRA 2005 5". @param {string} source */
export const sourceWords = (source) =>
  source.replace(/(^|[,;] )([A-D])(?= |$)/g, (_, before, letter) => before + PAPERS[letter]);

/** What evidence makes of a place, in words. @param {number} nats log likelihood ratio */
export function likelier(nats) {
  const times = Math.exp(Math.abs(nats));
  if (times < 1.05) return "as likely as before";
  const words = times > 1e6 ? "over a million" : Number(times.toPrecision(2)).toLocaleString("en");
  return `${words} times ${nats > 0 ? "likelier" : "less likely"}`;
}

/** 1:30, 1:02:30. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (/** @type {number} */ value) => String(value).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** A time for people, to the tenth. @param {number} seconds */
export const fine = (seconds) => `${clock(seconds)}.${Math.floor(seconds * 10 + 1e-6) % 10}`;

let count = 0; // of all toasts so far

/**
 * A sentence stays long enough to be read, and for as long as somebody points at it; a click or Escape removes it.
 * @param {string} text @param {{ bad?: boolean, notice?: boolean, stays?: boolean }} [kind]
 */
export function toast(text, { bad = false, notice = false, stays = false } = {}) {
  const place = $(bad ? "alerts" : "toasts"); // what was refused is not wiped away by what was done
  for (const other of all())
    if (other.dataset.text === text || (other.parentElement === place && !("stays" in other.dataset))) other.remove();
  const box = document.createElement("div");
  box.className = bad ? "toast bad" : "toast";
  Object.assign(box.dataset, { text, number: String(++count) });
  const close = document.createElement("button");
  Object.assign(close, { type: "button", className: "bare", title: "Dismiss (Escape)" });
  close.setAttribute("aria-label", "Dismiss");
  close.append(icon("close"));
  box.append(
    icon(bad ? "warn" : notice ? "info" : "check"),
    Object.assign(document.createElement("span"), { textContent: text }),
    close,
  );
  box.addEventListener("click", () => box.remove());
  place.append(box);
  if (stays) box.dataset.stays = "";
  else leave(box, 4000 + 80 * text.length);
  return box;
}

// Removes the newest; true when there was one.
export function dismissToast() {
  const newest = all().at(-1);
  newest?.remove();
  return newest !== undefined;
}

// Oldest first.
const all = () => {
  /** @type {NodeListOf<HTMLElement>} */
  const boxes = $("line").querySelectorAll(".toast");
  return [...boxes].sort((a, b) => Number(a.dataset.number) - Number(b.dataset.number));
};

/** @param {HTMLElement} box @param {number} after_ms */
function leave(box, after_ms) {
  const unread = () => document.hidden || box.matches(":hover, :focus-within");
  setTimeout(() => box.isConnected && (unread() ? leave(box, after_ms) : box.remove()), after_ms);
}

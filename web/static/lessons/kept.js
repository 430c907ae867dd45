// What this browser keeps of lessons: which have been gone through, and the name under which it votes.

const DONE = "lessons done";
const VOTER = "voter";

/** @returns {string[]} */
export function done() {
  try {
    const kept = JSON.parse(localStorage.getItem(DONE) ?? "[]");
    return Array.isArray(kept) ? kept.map(String) : [];
  } catch {
    return []; // this browser stores nothing
  }
}

/** @param {string} name */
export function setDone(name) {
  try {
    localStorage.setItem(DONE, JSON.stringify([...new Set([...done(), name])]));
  } catch {
    // It is not marked.
  }
}

/** A text that is this browser's own. Each voter counts once. @returns {string} */
export function voter() {
  const fresh = [...crypto.getRandomValues(new Uint8Array(12))].map((byte) => byte.toString(16)).join("-");
  try {
    const kept = localStorage.getItem(VOTER) ?? fresh;
    localStorage.setItem(VOTER, kept);
    return kept;
  } catch {
    return fresh; // until the page is loaded again
  }
}

// What the page can run until, and how it says so. No DOM.

/** @type {{ words: string, wish: Omit<RunUntil, "type"> }[]} */
export const CHOICES = [
  { words: "a loop closes", wish: { what: "closure" } },
  { words: "it is lost", wish: { what: "lost" } },
  { words: "it knows again where it is", wish: { what: "found again" } },
  { words: "the packet snaps", wish: { what: "snap" } },
  { words: "it is at its goal", wish: { what: "goal reached" } },
];

/** So many packets can be waited for. */
export const PACKETS = { least: 2, most: 9 };

/** What is said when it has happened; null while it runs, and if it was broken off. A warning says that it came too late. @param {UntilView} until */
export const ending = ({ state, words }) => (state === "met" ? `Stopped at this very tick: ${words}.` : null);
